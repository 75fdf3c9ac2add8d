"""Columns of numbers without a header: ``frame id x y`` as Social-GAN ships ETH and UCY, and EWAP's ``obsmat.txt``.

``obsmat.txt`` has eight columns: frame, id, x, z, y, vx, vz, vy, of which z is not used and the velocities are metres a
second. Columns stand apart by spaces, tabs, commas or semicolons.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from surveillance_domain.trajectories.rows import (
    COMMENT_SIGNS,
    WITH_POINTS,
    LineBlock,
    Rows,
    RowsBuilder,
    finite_numbers,
    has_decimal_comma,
    number_of,
    track_name,
)

__all__ = ["parted", "read_frame_text", "read_obsmat"]

_PARTING = str.maketrans(",;", "  ")


def read_frame_text(blocks: Iterable[LineBlock], source: str) -> Rows:
    """Four columns: frame, id, x, y.

    Raises
    ------
    TrajectoryError
        Naming every line that does not hold four finite numbers.
    """
    return _read(blocks, source, ("frame", "id", "x", "y"), ("frame", "x", "y"))


def read_obsmat(blocks: Iterable[LineBlock], source: str) -> Rows:
    """Eight columns: frame, id, x, z, y, vx, vz, vy.

    Raises
    ------
    TrajectoryError
        Naming every line that does not hold eight finite numbers.
    """
    return _read(blocks, source, ("frame", "id", "x", "z", "y", "vx", "vz", "vy"), ("frame", "x", "y", "vx", "vy"))


def _read(blocks: Iterable[LineBlock], source: str, columns: tuple[str, ...], used: tuple[str, ...]) -> Rows:
    builder = RowsBuilder(source)
    places = [columns.index(name) for name in used]
    for first, written in blocks:
        lines = [parted(line) for line in written] if parted(written[0]) != written[0] else written
        table = finite_numbers(lines, len(columns))
        if table is not None:
            builder.add_block(first, table[:, 1], table[:, places])
        else:
            _read_lines(builder, first, written, columns, used)
    return builder.rows_read()


def parted(line: str) -> str:
    """The line with white space alone between its columns."""
    return line.translate(_PARTING)


def _read_lines(
    builder: RowsBuilder, first: int, lines: Sequence[str], columns: tuple[str, ...], used: tuple[str, ...]
) -> None:
    """Line by line, so that every fault is told with its own."""
    expected = f"{len(columns)} numbers: {', '.join(columns)}"
    for number, line in enumerate(lines, start=first):
        words = parted(line).split()
        if not words:
            continue
        if line.lstrip().startswith(COMMENT_SIGNS):
            builder.fault(number, "a comment", f"{expected}; leave comments out")
            continue
        if len(words) != len(columns):
            builder.fault(
                number, f"{len(words)} columns", f"{expected}{WITH_POINTS if has_decimal_comma(line) else ''}"
            )
            continue
        values = {name: number_of(word) for name, word in zip(columns, words, strict=True) if name != "id"}
        wrong = [name for name, value in values.items() if value is None]
        if wrong:
            found = ", ".join(f"{name} = {words[columns.index(name)]!r}" for name in wrong)
            builder.fault(number, found, f"finite numbers for {', '.join(values)}")
            continue
        builder.add(number, track_name(words[1]), [float(values[name] or 0.0) for name in used])
