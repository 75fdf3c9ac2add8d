"""Whether walls stand between a camera and the floor, decided in whole numbers.

Positions are rounded to 1/4096 of a cell, so every comparison is exact and a camera on the edge of a cell is exactly on
it. The segment from camera to target is followed cell by cell (Amanatides & Woo, "A fast voxel traversal algorithm for
ray tracing", Eurographics 1987). The view is blocked if the segment

- enters the inside of a blocked cell (a camera on the edge of a wall is not inside it, so it sees everything on its own
  side of that edge and nothing through the wall), or
- passes, between its ends, a corner whose two side cells are both blocked. One blocked side cell does not block, and
  neither does the corner in which a camera is mounted.

Outside of the map nothing blocks. Time: targets times cells on the way; memory: targets.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.site.grid import Grid

__all__ = ["line_of_sight"]

_UNITS = 4096


def line_of_sight(
    grid: Grid, position_m: Float[np.ndarray, " 2"], points_m: Float[np.ndarray, "points 2"]
) -> Bool[np.ndarray, " points"]:
    """Which points on the floor can be seen from a position if only walls limit the view (both in metres)."""
    from surveillance_domain.model.sight_kernel import walk_segments

    visible = np.empty(len(points_m), dtype=bool)
    walk_segments(~grid.free, _in_units(grid, position_m), _in_units(grid, points_m), _UNITS, visible)
    return visible


def _in_units(grid: Grid, points_m: Float[np.ndarray, "... 2"]) -> Int[np.ndarray, "... 2"]:
    return np.rint((points_m - np.asarray(grid.origin_m)) / grid.cell_m * _UNITS).astype(np.int64)
