"""CSV with named columns: ``frame`` or ``time_s``, ``id``, ``x``, ``y``, in any order, among others.

Columns of other names are given by the user, as ``{"x": "pos_x"}``.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.rows import Rows, RowsBuilder, TrajectoryError, number_of, track_name

__all__ = ["COLUMNS", "read_csv"]

COLUMNS = ("frame", "time_s", "id", "x", "y")
"""What a column can be; of the first two, one is needed. With ``time_s`` the file has no frames to be counted."""


def read_csv(lines: Sequence[str], source: str, columns: Mapping[str, str] | None = None) -> Rows:
    """Rows of a CSV file.

    Parameters
    ----------
    columns : mapping, optional
        From one of `COLUMNS` to the header that holds it, where that has another name.

    Raises
    ------
    TrajectoryError
        Naming the columns that are missing, or every line that does not fit.
    """
    first = next(line for line in lines if line.strip())
    reader = csv.reader(lines, skipinitialspace=True, delimiter=max(",;\t", key=first.count))
    header = [name.strip() for name in next(words for words in reader if words)]
    places = _places(header, dict(columns or {}), source)
    timed = "time_s" in places
    used = ("time_s" if timed else "frame", "x", "y")
    builder = RowsBuilder(source)
    for words in reader:
        if not words:
            continue
        if len(words) != len(header):
            builder.fault(reader.line_num, f"{len(words)} columns", f"{len(header)}, as the header has")
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
            builder.fault(reader.line_num, ", ".join(wrong), f"finite numbers for {', '.join(used)}, and a name for id")
        else:
            builder.add(reader.line_num, track_name(track), [value for value in values if value is not None])
    return builder.rows_read(frames_per_s=1.0 if timed else None)


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
