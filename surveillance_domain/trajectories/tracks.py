"""Trajectories in metres and seconds, and what had to be done to get them."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

if TYPE_CHECKING:
    from surveillance_domain.trajectories.findings import Finding

__all__ = ["Counts", "Track", "Tracks"]


@dataclass(frozen=True, eq=False)
class Track:
    """One person's way without a break.

    Attributes
    ----------
    name : str
        Of the person; the parts of one that was cut share it.
    times_s : (points,) float
        Rising.
    points_m : (points, 2) float
    lines : (points,) int, optional
        Of the file, where the points stand in one.
    """

    name: str
    times_s: Float[np.ndarray, " points"]
    points_m: Float[np.ndarray, "points 2"]
    lines: Int[np.ndarray, " points"] | None = None


@dataclass(frozen=True)
class Counts:
    """What was found in a file and what became of it.

    Attributes
    ----------
    rows, people : int
        As they stand in the file.
    repeated_rows : int
        The same person, frame and place a second time; left out.
    contradictory_frames : int
        Frames at which one person is at two places; left out.
    contradictory_people : int
        People of whom no frame is left, because each has them at two places; left out.
    out_of_order_rows : int
        Rows of an earlier frame than the person's row before; put in order.
    gaps_filled : int
        Missing frames within the limit, interpolated where they are needed.
    gaps_cut : int
        Longer ones, at which the track was cut.
    jumps : int
        Moves faster than the limit, at which the track was cut.
    single_points : int
        Tracks of one point, and parts of one that cutting left; left out.
    other_units : int
        People of whom most moves are faster than the limit, as if written in another unit; left out.
    """

    rows: int = 0
    people: int = 0
    repeated_rows: int = 0
    contradictory_frames: int = 0
    contradictory_people: int = 0
    out_of_order_rows: int = 0
    gaps_filled: int = 0
    gaps_cut: int = 0
    jumps: int = 0
    single_points: int = 0
    other_units: int = 0

    def __add__(self, other: Counts) -> Counts:
        return Counts(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(Counts)))

    def as_dict(self) -> dict[str, int]:
        """Under the names that a JSON answer has."""
        return asdict(self)


@dataclass(frozen=True, eq=False)
class Tracks:
    """What a file came to.

    Attributes
    ----------
    tracks : tuple of Track
        Each of at least two points.
    frame_s : float
        Usual time between two annotations of one person.
    counts : Counts
    warnings : tuple of str
        What looks wrong but was taken as it stands.
    findings : tuple of Finding
        What was wrong and dealt with, one for each kind.
    """

    tracks: tuple[Track, ...]
    frame_s: float
    counts: Counts
    warnings: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()

    @property
    def people(self) -> tuple[str, ...]:
        """Their names, each once."""
        return tuple(dict.fromkeys(track.name for track in self.tracks))
