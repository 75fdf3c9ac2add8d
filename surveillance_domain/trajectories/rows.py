"""What a file of trajectories says, row by row, before anything is made of it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.site.faults import Fault, SiteError

__all__ = ["Rows", "RowsBuilder", "TrajectoryError", "number_of", "track_name"]

_MOST_FAULTS = 10


class TrajectoryError(SiteError):
    """Trajectories that cannot be used: the file, and everything that is wrong with it, as a site's faults are told."""


@dataclass(frozen=True, eq=False)
class Rows:
    """One observation a row, in the file's own numbers and order.

    Attributes
    ----------
    frames : (rows,) float
        Number of the frame, or seconds where ``frames_per_s`` is 1 because the file tells the time.
    tracks : (rows,) int
        Index into ``names``.
    points : (rows, 2) float
        x and y in the file's unit.
    lines : (rows,) int
        Number of the line, from 1.
    names : tuple of str
        Names of the tracks, in the order in which they appear.
    frames_per_s : float or None
        What the file itself says of its rate.
    velocities : (rows, 2) float or None
        Metres a second, where the file tells them; only compared with the positions, never used.
    """

    frames: Float[np.ndarray, " rows"]
    tracks: Int[np.ndarray, " rows"]
    points: Float[np.ndarray, "rows 2"]
    lines: Int[np.ndarray, " rows"]
    names: tuple[str, ...]
    frames_per_s: float | None = None
    velocities: Float[np.ndarray, "rows 2"] | None = None


@dataclass
class RowsBuilder:
    """Collects rows and faults while a file is read."""

    source: str
    rows: list[tuple[int, str, tuple[float, ...]]] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    def add(self, line: int, track: str, numbers: Sequence[float]) -> None:
        """One row: frame, x and y, and after them the velocity where the file has one."""
        self.rows.append((line, track, tuple(numbers)))

    def fault(self, line: int, found: str, expected: str) -> None:
        """Something wrong on a line."""
        self.faults.append(Fault(f"line {line}", found, expected))

    def rows_read(self, frames_per_s: float | None = None) -> Rows:
        """All rows.

        Raises
        ------
        TrajectoryError
            With the first ten faults and the number of the others, or if there is no row at all.
        """
        if self.faults:
            shown, more = self.faults[:_MOST_FAULTS], len(self.faults) - _MOST_FAULTS
            if more > 0:
                shown = [*shown, Fault("", f"{more} more faults of this kind", "as above")]
            raise TrajectoryError(self.source, tuple(shown))
        if not self.rows:
            raise TrajectoryError(self.source, (Fault("", "no observation", "one row for each person and frame"),))
        names = tuple(dict.fromkeys(track for _, track, _ in self.rows))
        index = {name: number for number, name in enumerate(names)}
        numbers = np.array([row for _, _, row in self.rows], dtype=float)
        return Rows(
            frames=numbers[:, 0],
            tracks=np.array([index[track] for _, track, _ in self.rows]),
            points=numbers[:, 1:3],
            lines=np.array([line for line, _, _ in self.rows]),
            names=names,
            frames_per_s=frames_per_s,
            velocities=numbers[:, 3:5] if numbers.shape[1] > 3 else None,
        )


def number_of(text: str) -> float | None:
    """A finite number; ``None`` for anything else."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def track_name(text: str) -> str:
    """The name of a track; ``12``, ``12.0`` and ``1.2e+01`` are the same one."""
    number = number_of(text)
    return str(int(number)) if number is not None and number.is_integer() else text.strip()
