"""CSV with named columns: ``frame`` or ``time_s``, ``id``, ``x``, ``y``, in any order, among others.

Columns of other names are given by the user, as ``{"x": "pos_x"}``.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, pairwise

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.rows import (
    WITH_POINTS,
    LineBlock,
    Rows,
    RowsBuilder,
    TrajectoryError,
    finite_numbers,
    has_decimal_comma,
    number_of,
    track_name,
)

__all__ = ["COLUMNS", "read_csv"]

COLUMNS = ("frame", "time_s", "id", "x", "y")
"""What a column can be; of the first two, one is needed; ``time_s`` goes before ``frame``, unless that was named."""


def read_csv(blocks: Iterable[LineBlock], source: str, columns: Mapping[str, str] | None = None) -> Rows:
    """Rows of a CSV file.

    Parameters
    ----------
    blocks : iterable of (int, lines)
        The first of them with a line that is not empty: the header.
    columns : mapping, optional
        From one of `COLUMNS` to the header that holds it, where that has another name.

    Raises
    ------
    TrajectoryError
        Naming the columns that are missing, or every line that does not fit.
    """
    rest = iter(blocks)
    number, lines = next(rest)
    empty = next(place for place, line in enumerate(lines) if line.strip())
    delimiter = max(",;\t", key=lines[empty].count)
    header = [name.strip() for name in next(csv.reader(lines[empty:], skipinitialspace=True, delimiter=delimiter))]
    named = dict(columns or {})
    places = _places(header, named, source)
    timed = "time_s" in places and ("time_s" in named or "frame" not in named)
    table = _Table(header, places, ("time_s" if timed else "frame", "x", "y"), delimiter)
    builder = RowsBuilder(source)
    table.read(builder, chain([(number + empty + 1, lines[empty + 1 :])], rest))
    return builder.rows_read(frames_per_s=1.0 if timed else None, timed=timed)


class _Table:
    """What stands below the header."""

    def __init__(self, header: list[str], places: Mapping[str, int], used: tuple[str, ...], delimiter: str) -> None:
        self._header, self._places, self._used, self._delimiter = header, places, used, delimiter
        self._wanted = [places["id"], *(places[name] for name in used)]

    def read(self, builder: RowsBuilder, blocks: Iterator[LineBlock]) -> None:
        """A block at a time; from the first quote on line by line, since quoted words may go over several."""
        for first, lines in blocks:
            if any('"' in line for line in lines):
                self._read_lines(builder, first, chain(lines, *(more for _, more in blocks)))
                return
            table = finite_numbers(lines, len(self._header), self._delimiter, self._wanted) if lines else None
            if table is not None:
                builder.add_block(first, table[:, 0], table[:, 1:])
            else:
                self._read_lines(builder, first, lines)

    def _read_lines(self, builder: RowsBuilder, first: int, lines: Iterable[str]) -> None:
        header, places, used = self._header, self._places, self._used
        reader = csv.reader(lines, skipinitialspace=True, delimiter=self._delimiter)
        for words in reader:
            line = first + reader.line_num - 1
            if not words:
                continue
            if len(words) != len(header):
                halves = any(word.strip().isdigit() and more.isdigit() for word, more in pairwise(words))
                comma = (
                    self._delimiter == "," and len(words) > len(header) and halves and not any("." in w for w in words)
                )
                expected = f"{len(header)}, as the header has{WITH_POINTS if comma else ''}"
                builder.fault(line, f"{len(words)} columns", expected)
                continue
            values = [number_of(words[places[name]]) for name in used]
            track = words[places["id"]].strip()
            wrong = [
                f"{header[places[name]]} = {words[places[name]]!r}"
                for name, value in zip(used, values, strict=True)
                if value is None
            ]
            if not track:
                wrong.append(f"{header[places['id']]} = ''")
            if wrong:
                expected = f"finite numbers for {', '.join(used)}, and a name for id"
                comma = has_decimal_comma(" ".join(words[places[name]] for name in used))
                builder.fault(line, ", ".join(wrong), f"{expected}{WITH_POINTS if comma else ''}")
            else:
                builder.add(line, track_name(track), [value for value in values if value is not None])


def _places(header: list[str], columns: dict[str, str], source: str) -> dict[str, int]:
    """Where each column stands."""
    lower = [name.lower() for name in header]
    wanted = {name: columns.get(name, name) for name in COLUMNS}
    faults = [Fault("", f"columns: {key!r}", f"one of {', '.join(COLUMNS)}") for key in columns if key not in COLUMNS]
    faults += [
        Fault("line 1", f"no column {named!r} for {name}", f"one of the file's columns {', '.join(header)}")
        for name, named in columns.items()
        if name in COLUMNS and named.lower() not in lower
    ]
    places = {name: lower.index(named.lower()) for name, named in wanted.items() if named.lower() in lower}
    missing = [name for name in ("id", "x", "y") if name not in places and name not in columns]
    if "frame" not in places and "time_s" not in places and not {"frame", "time_s"} & columns.keys():
        missing.insert(0, "frame or time_s")
    if missing:
        expected = "frame or time_s, id, x and y; other names are told by --columns, such as x=pos_x,id=person"
        faults.append(Fault("line 1", f"no column {', '.join(missing)} among {', '.join(header)}", expected))
    twice = sorted({name for name in lower if name and lower.count(name) > 1})
    if twice:
        faults.append(Fault("line 1", f"the column {', '.join(twice)} more than once", "each name once"))
    if faults:
        raise TrajectoryError(source, tuple(faults))
    return places
