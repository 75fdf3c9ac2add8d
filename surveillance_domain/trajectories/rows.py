"""What a file of trajectories says, row by row, before anything is made of it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.site.faults import Fault, SiteError

__all__ = [
    "COMMENT_SIGNS",
    "WITH_POINTS",
    "LineBlock",
    "Rows",
    "RowsBuilder",
    "TrajectoryError",
    "finite_numbers",
    "has_decimal_comma",
    "number_of",
    "numbered",
    "track_name",
]

_MOST_FAULTS = 10
_MOST_SINGLE = 100_000
_EXACT = 2**53

_DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(e[-+]?\d+)?", re.IGNORECASE)
COMMENT_SIGNS = ("#", "%", "//")
WITH_POINTS = "; decimals stand behind a point: 8.46, not 8,46"

LineBlock = tuple[int, Sequence[str]]
"""Successive lines of a file, and the number of the first."""


class TrajectoryError(SiteError):
    """Trajectories that cannot be used: the file, and everything that is wrong with it, as a site's faults are told."""


@dataclass(frozen=True, eq=False)
class Rows:
    """One observation a row, in the file's own numbers and order.

    Attributes
    ----------
    frames : (rows,) float
        Number of the frame, or seconds where the file tells the time.
    tracks : (rows,) int
        Index into ``names``.
    points : (rows, 2) float
        x and y in the file's unit.
    lines : (rows,) int
        Number of the line, from 1.
    names : tuple of str
        Names of the tracks, in the order in which they appear.
    frames_per_s : float or None
        What the file itself says of its rate; 1 where it tells the time.
    velocities : (rows, 2) float or None
        Metres a second, where the file tells them; only compared with the positions, never used.
    timed : bool
        Whether ``frames`` are seconds.
    """

    frames: Float[np.ndarray, " rows"]
    tracks: Int[np.ndarray, " rows"]
    points: Float[np.ndarray, "rows 2"]
    lines: Int[np.ndarray, " rows"]
    names: tuple[str, ...]
    frames_per_s: float | None = None
    velocities: Float[np.ndarray, "rows 2"] | None = None
    timed: bool = False


class RowsBuilder:
    """Collects rows and faults while a file is read: many at a time where they are plain, else one by one."""

    def __init__(self, source: str) -> None:
        self.source = source
        self._index: dict[str, int] = {}
        self._blocks: list[tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"], Float[np.ndarray, "n columns"]]] = []
        self._single: list[tuple[int, int, tuple[float, ...]]] = []
        self._faults: list[Fault] = []
        self._more_faults = 0

    def add(self, line: int, track: str, numbers: Sequence[float]) -> None:
        """One row: frame, x and y, and after them the velocity where the file has one."""
        self._single.append((line, self._index.setdefault(track, len(self._index)), tuple(numbers)))
        if len(self._single) >= _MOST_SINGLE:
            self._close_single()

    def add_block(
        self, first_line: int, tracks: Float[np.ndarray, " n"], numbers: Float[np.ndarray, "n columns"]
    ) -> None:
        """Rows of successive lines; names of tracks that are whole numbers."""
        self._close_single()
        named, first, own = np.unique(tracks, return_index=True, return_inverse=True)
        place = np.empty(len(named), dtype=np.int64)
        for number in np.argsort(first).tolist():
            place[number] = self._index.setdefault(str(int(named[number])), len(self._index))
        self._blocks.append((first_line + np.arange(len(tracks)), place[own], numbers))

    def fault(self, line: int, found: str, expected: str) -> None:
        """Something wrong on a line."""
        if len(self._faults) < _MOST_FAULTS:
            self._faults.append(Fault(f"line {line}", found, expected))
        else:
            self._more_faults += 1

    def rows_read(self, frames_per_s: float | None = None, timed: bool = False) -> Rows:
        """All rows.

        Raises
        ------
        TrajectoryError
            With the first ten faults and the number of the others, or if there is no row at all.
        """
        if self._faults:
            more = [Fault("", f"{self._more_faults} more faults of this kind", "as above")]
            raise TrajectoryError(self.source, (*self._faults, *(more if self._more_faults else ())))
        self._close_single()
        if not self._blocks:
            raise TrajectoryError(self.source, (Fault("", "no observation", "one row for each person and frame"),))
        lines, tracks, numbers = (np.concatenate(parts) for parts in zip(*self._blocks, strict=True))
        self._blocks.clear()
        return Rows(
            frames=numbers[:, 0].copy(),
            tracks=tracks,
            points=numbers[:, 1:3].copy(),
            lines=lines,
            names=tuple(self._index),
            frames_per_s=frames_per_s,
            velocities=numbers[:, 3:5].copy() if numbers.shape[1] > 3 else None,
            timed=timed,
        )

    def _close_single(self) -> None:
        if self._single:
            lines, tracks, numbers = zip(*self._single, strict=True)
            self._blocks.append((np.array(lines), np.array(tracks), np.array(numbers, dtype=float)))
            self._single = []


def finite_numbers(
    lines: Sequence[str], columns: int, delimiter: str | None = None, used: Iterable[int] | None = None
) -> Float[np.ndarray, "lines used"] | None:
    """A block of lines as numbers, where every line is plain: none empty, all numbers finite, the first a whole one.

    Parameters
    ----------
    lines : sequence of str
    columns : int
        How many each line has.
    delimiter : str, optional
        Without it, white space.
    used : iterable of int, optional
        Which columns, the names of tracks first; without it all, and names in the second.

    Returns
    -------
    array or None
        ``None``: some line is to be looked at by itself.
    """
    wanted = None if used is None else list(used)
    try:
        if delimiter is not None and any(line.count(delimiter) != columns - 1 for line in lines):
            return None
        found = np.loadtxt(lines, delimiter=delimiter, usecols=wanted, ndmin=2, comments=None)
    except ValueError:
        return None
    if len(found) != len(lines) or (wanted is None and found.shape[1] != columns) or not np.isfinite(found).all():
        return None
    tracks = found[:, 1 if wanted is None else 0]
    plain = (np.abs(tracks) < _EXACT).all() and (tracks == np.floor(tracks)).all()
    return found if plain else None


def numbered(blocks: Iterable[Sequence[str]]) -> Iterator[LineBlock]:
    """Blocks of lines with the number of their first one."""
    first = 1
    for lines in blocks:
        yield first, lines
        first += len(lines)


def number_of(text: str) -> float | None:
    """A finite number; ``None`` for anything else."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def has_decimal_comma(line: str) -> bool:
    """Whether words that stand apart by white space or semicolons have one such as ``8,46``."""
    words = line.replace(";", " ").split()
    return len(words) > 1 and any(_DECIMAL_COMMA.fullmatch(word) for word in words)


def track_name(text: str) -> str:
    """The name of a track; ``12``, ``12.0`` and ``1.2e+01`` are the same one."""
    number = number_of(text)
    plain = number is not None and abs(number) < _EXACT and number.is_integer()
    return str(int(number)) if plain and number is not None else text.strip()
