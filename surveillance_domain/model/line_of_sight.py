"""Whether walls stand between a camera and the floor, decided in whole numbers.

Positions are rounded to 1/4096 of a cell, so every comparison below is exact and a camera on the edge of a cell is
exactly on it. The segment from camera to target is followed cell by cell (Amanatides & Woo, "A fast voxel traversal
algorithm for ray tracing", Eurographics 1987), for all targets at once. Its view is blocked if

- it enters the inside of a blocked cell (a camera on the edge of a wall is not inside it, so it sees everything on
  its own side of that edge and nothing through the wall), or
- between its ends it passes a corner whose two side cells are both blocked. One blocked side cell does not block, and
  neither does the corner in which a camera is mounted.

Outside of the map nothing blocks. Time: targets times cells on the way; memory: targets.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.site.grid import Grid

__all__ = ["line_of_sight"]

_UNITS = 4096
_FAR = np.int64(2**62)


def line_of_sight(
    grid: Grid, position_m: Float[np.ndarray, " 2"], points_m: Float[np.ndarray, "points 2"]
) -> Bool[np.ndarray, " points"]:
    """Which points on the floor can be seen from a position if only walls limit the view (both in metres)."""
    start, ends = _in_units(grid, position_m), _in_units(grid, points_m)
    travel = ends - start
    step = np.sign(travel)
    target = ends // _UNITS
    cell = np.where(step < 0, -(-start // _UNITS) - 1, start // _UNITS)
    to_edge = np.where(step < 0, start - cell * _UNITS, (cell + 1) * _UNITS - start)
    # The next vertical edge is met before the next horizontal one where due[:, 0] < due[:, 1].
    pace = np.abs(travel[:, ::-1])
    due = np.where(step == 0, _FAR, to_edge * pace)
    walls = np.pad(~grid.free, 1)
    visible = np.zeros(len(ends), dtype=bool)
    active = np.arange(len(ends))
    while active.size:
        open_ = ~_blocked(walls, cell)
        arrived = open_ & np.all(cell == target, axis=1)
        visible[active[arrived]] = True
        keep = open_ & ~arrived
        active, cell, target, step, pace, due = (each[keep] for each in (active, cell, target, step, pace, due))
        moves = due <= due[:, ::-1]
        corner = moves.all(axis=1)
        shut = corner & _blocked(walls, cell + step * [1, 0]) & _blocked(walls, cell + step * [0, 1])
        cell, due = cell + step * moves, due + moves * pace * _UNITS
        active, cell, target, step, pace, due = (each[~shut] for each in (active, cell, target, step, pace, due))
    return visible


def _in_units(grid: Grid, points_m: Float[np.ndarray, "... 2"]) -> Int[np.ndarray, "... 2"]:
    return np.rint((points_m - np.asarray(grid.origin_m)) / grid.cell_m * _UNITS).astype(np.int64)


def _blocked(walls: Bool[np.ndarray, "_ _"], cell: Int[np.ndarray, "points 2"]) -> Bool[np.ndarray, " points"]:
    """Which cells are walls; ``walls`` has a margin of one open cell, to which everything outside is moved."""
    column = np.clip(cell[:, 0] + 1, 0, walls.shape[1] - 1)
    row = np.clip(cell[:, 1] + 1, 0, walls.shape[0] - 1)
    return walls[row, column]
