"""A recording placed into a site: one common clock, one frame, and who is on the map when.

The scene is rotated about its own origin, then moved. A point off the map is *outside*; one in a wall is put to the
nearest free place if that is less than a cell away, and is outside otherwise; both are counted.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.resampling import resampled
from surveillance_domain.trajectories.tracks import Track

__all__ = ["Placement", "Stage", "nobody_on_map", "on_free_cells", "staged", "windows"]

_WITHIN_CELLS = 1e-6


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
    """Who is where, step by step.

    Attributes
    ----------
    people : tuple of str
        Those who are on the map at some time.
    path_m : (times, people, 2) float
        x and y in metres in the site's frame; nan while a person is outside. Always on a free cell.
    step_s : float
    off_map, in_walls, moved_out_of_walls : int
        Points that fell off the map; that lay in walls and count as outside; that were put beside the wall.
    """

    people: tuple[str, ...]
    path_m: Float[np.ndarray, "times people 2"]
    step_s: float
    off_map: int = 0
    in_walls: int = 0
    moved_out_of_walls: int = 0

    def window(self, start: int, steps: int) -> Stage:
        """A piece of ``steps`` steps from time ``start``, with only those who are on the map after one of its steps."""
        path = self.path_m[start : start + steps + 1]
        there = np.isfinite(path[1:, :, 0]).any(axis=0)
        names = tuple(name for name, is_there in zip(self.people, there, strict=True) if is_there)
        return Stage(names, path[:, there], self.step_s)


def staged(tracks: Sequence[Track], grid: Grid, placement: Placement, step_s: float) -> Stage:
    """Place tracks into a map and sample them all at the same times, from the first of the recording on.

    Raises
    ------
    ValueError
        If nobody ever is on the map, saying where people are instead.
    """
    origin = min(float(track.times_s[0]) for track in tracks)
    end = max(float(track.times_s[-1]) for track in tracks)
    names = tuple(dict.fromkeys(track.name for track in tracks))
    column = {name: number for number, name in enumerate(names)}
    path = np.full((math.floor((end - origin) / step_s + 1e-9) + 1, len(names), 2), np.nan)
    for track in tracks:
        stepped = resampled(track, step_s, origin)
        if stepped is not None:
            first = round((float(stepped.times_s[0]) - origin) / step_s)
            path[first : first + len(stepped.times_s), column[track.name]] = placement.placed(stepped.points_m)
    known = np.isfinite(path[..., 0])
    points = path[known]
    placed, off_map, in_walls, moved = on_free_cells(points, grid)
    path[known] = placed
    there = np.isfinite(path[..., 0]).any(axis=0)
    if not there.any():
        raise nobody_on_map(points, grid)
    people = tuple(name for name, is_there in zip(names, there, strict=True) if is_there)
    return Stage(people, path[:, there], step_s, off_map, in_walls, moved)


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


def windows(stage: Stage, steps: int, most: int | None = None, start: int = 0) -> tuple[list[Stage], int]:
    """Pieces of ``steps`` steps, one after the other from time ``start`` on, and how many were empty.

    Where the recording is shorter than one piece, it is the only one. Pieces in which nobody is on the map are left
    out, and do not count among the ``most``.
    """
    made: list[Stage] = []
    empty = 0
    last = max(len(stage.path_m) - 1 - steps, start)
    for begin in range(start, last + 1, steps):
        piece = stage.window(begin, steps)
        if len(piece.path_m) < 2 or not piece.people:
            empty += 1
        elif most is None or len(made) < most:
            made.append(piece)
    return made, empty
