"""A recording placed into a site: one common clock, one frame, and who is on the map when.

The scene is rotated about its own origin, then moved. A point off the map is *outside*; one in a wall is put to the
nearest free place if that is less than a cell away, and is outside otherwise; both are counted. Only the people of a
piece are laid out step by step, so that a long recording takes no more room than its points.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.resampling import MOST_STEPS, resampled
from surveillance_domain.trajectories.tracks import Track

__all__ = ["Part", "Placement", "Stage", "Staged", "nobody_on_map", "on_free_cells", "staged", "windows"]

_WITHIN_CELLS = 1e-6
_MOST_TIMES = 2**53


@dataclass(frozen=True)
class Placement:
    """Where a recording lies in a site.

    Attributes
    ----------
    offset_m : (float, float)
        Where the recording's origin comes to lie.
    rotate_deg : float
        Counter-clockwise, about that origin.
    """

    offset_m: tuple[float, float] = (0.0, 0.0)
    rotate_deg: float = 0.0

    def placed(self, points_m: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "points 2"]:
        """Points of the recording in the site's frame."""
        angle = math.radians(self.rotate_deg)
        turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        return points_m @ turn.T + np.array(self.offset_m)


@dataclass(frozen=True, eq=False)
class Stage:
    """A piece of a recording: who is where, step by step.

    Attributes
    ----------
    people : tuple of str
        Those who are on the map at some time.
    path_m : (times, people, 2) float
        x and y in metres in the site's frame; nan while a person is outside. Always on a free cell.
    step_s : float
    """

    people: tuple[str, ...]
    path_m: Float[np.ndarray, "times people 2"]
    step_s: float


class Part(NamedTuple):
    """Where one person is at successive steps from ``first`` on; nan while outside."""

    person: str
    first: int
    path_m: Float[np.ndarray, "steps 2"]


@dataclass(frozen=True, eq=False)
class Staged:
    """A whole recording in a site.

    Attributes
    ----------
    people : tuple of str
        All of the recording, in order of their tracks; so they stand in every piece, too.
    parts : tuple of Part
    times : int
        How many there are, from the first of the recording on.
    step_s : float
    off_map, in_walls, moved_out_of_walls : int
        Points that fell off the map; that lay in walls and count as outside; that were put beside the wall.
    """

    people: tuple[str, ...]
    parts: tuple[Part, ...]
    times: int
    step_s: float
    off_map: int = 0
    in_walls: int = 0
    moved_out_of_walls: int = 0

    @property
    def positions(self) -> int:
        """How many points are on the map."""
        return sum(int(np.isfinite(part.path_m[:, 0]).sum()) for part in self.parts)

    def window(self, start: int, steps: int) -> Stage:
        """A piece of ``steps`` steps from time ``start``, with only those who are on the map after one of its steps."""
        end = min(start + steps + 1, self.times)
        met = [part for part in self.parts if part.first < end and part.first + len(part.path_m) > start]
        concerned = {part.person for part in met}
        column = {name: number for number, name in enumerate(one for one in self.people if one in concerned)}
        path = np.full((max(end - start, 0), len(column), 2), np.nan)
        for part in met:
            begin = max(part.first, start)
            piece = part.path_m[begin - part.first : end - part.first]
            path[begin - start : begin - start + len(piece), column[part.person]] = piece
        there = np.isfinite(path[1:, :, 0]).any(axis=0)
        names = tuple(name for name, is_there in zip(column, there, strict=True) if is_there)
        return Stage(names, path[:, there], self.step_s)


def staged(tracks: Sequence[Track], grid: Grid, placement: Placement, step_s: float) -> Staged:
    """Place tracks into a map and sample them all at the same times, from the first of the recording on.

    Raises
    ------
    ValueError
        If nobody ever is on the map, saying where people are instead; or if the recording spans more steps than can be
        counted, or one track of it more than can be laid out.
    """
    origin = min(float(track.times_s[0]) for track in tracks)
    end = max(float(track.times_s[-1]) for track in tracks)
    if not (end - origin) / step_s < _MOST_TIMES:
        raise ValueError(f"the recording goes from {origin:g} to {end:g} s; expected times in seconds")
    first: list[int] = []
    names: list[str] = []
    paths: list[np.ndarray] = []
    for track in tracks:
        stepped = resampled(track, step_s, origin)
        if stepped is not None:
            first.append(round((float(stepped.times_s[0]) - origin) / step_s))
            names.append(track.name)
            paths.append(placement.placed(stepped.points_m))
    points = np.concatenate([np.empty((0, 2)), *paths])
    if len(points) > MOST_STEPS:
        raise ValueError(f"{len(points):,} positions at steps of {step_s:g} s; at most {MOST_STEPS:,} are laid out")
    made, off_map, in_walls, moved = on_free_cells(points, grid)
    if not np.isfinite(made).any():
        raise nobody_on_map(points, grid)
    pieces = np.split(made, np.cumsum([len(path) for path in paths])[:-1])
    parts = tuple(Part(*part) for part in zip(names, first, pieces, strict=True))
    people = tuple(dict.fromkeys(track.name for track in tracks))
    times = math.floor((end - origin) / step_s + 1e-9) + 1
    return Staged(people, parts, times, step_s, off_map, in_walls, moved)


def nobody_on_map(points: Float[np.ndarray, "points 2"], grid: Grid) -> ValueError:
    """What is wrong with a placement that puts nobody on the map: where people are instead."""
    low, high = (", ".join(f"{x:.1f}" for x in end) for end in (points.min(axis=0), points.max(axis=0)))
    right, top = np.array(grid.origin_m) + grid.cell_m * np.array([grid.columns, grid.rows])
    return ValueError(
        f"nobody is ever on the map: people are between ({low}) and ({high}) m, the map between "
        f"({grid.origin_m[0]:.1f}, {grid.origin_m[1]:.1f}) and ({right:.1f}, {top:.1f}) m; "
        "give --offset-m and --rotate-deg"
    )


def on_free_cells(
    points: Float[np.ndarray, "points 2"], grid: Grid
) -> tuple[Float[np.ndarray, "points 2"], int, int, int]:
    """The points, nan where they are outside; and how many were off the map, in walls, and moved out of walls."""
    made = points.copy()
    cell = grid.cell_at(points)
    off = ((cell < 0) | (cell >= [grid.columns, grid.rows])).any(axis=1)
    blocked = np.flatnonzero(~off & (grid.number_at(points) < 0))
    made[off] = np.nan
    moved = 0
    half = grid.cell_m * (0.5 - _WITHIN_CELLS)
    for index in blocked.tolist():
        nearest = np.clip(points[index], grid.centres_m - half, grid.centres_m + half)
        away = np.hypot(*(nearest - points[index]).T)
        best = int(away.argmin())
        made[index] = nearest[best] if away[best] < grid.cell_m else np.nan
        moved += bool(away[best] < grid.cell_m)
    return made, int(off.sum()), len(blocked) - moved, moved


def windows(stage: Staged, steps: int, most: int | None = None, start: int = 0) -> tuple[list[Stage], int]:
    """Pieces of ``steps`` steps, one after the other from time ``start`` on, and how many were empty.

    Where the recording is shorter than one piece, it is the only one. Pieces in which nobody is on the map are left
    out, and do not count among the ``most``; only the others are laid out.
    """
    start = min(start, stage.times)
    count = max(stage.times - 1 - steps - start, 0) // steps + 1
    found: set[int] = set()
    for part in stage.parts:
        after = part.first + np.flatnonzero(np.isfinite(part.path_m[:, 0])) - start - 1
        found.update(np.unique(after[after >= 0] // steps).tolist())
    occupied = sorted(number for number in found if number < count)
    return [stage.window(start + number * steps, steps) for number in occupied[:most]], count - len(occupied)
