"""A point's straight way across a raster of free and blocked squares, followed from border to border.

Source: J. Amanatides and A. Woo, "A fast voxel traversal algorithm for ray tracing", Eurographics 1987. Cost: O(cells
crossed). Everything is in cell units: the cell (column, row) is the square from (column, row) to (column + 1, row + 1),
and what lies outside of the map is blocked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

__all__ = ["Wall", "first_wall"]

CORNER_CELLS = 1e-9
"""Ways that pass a corner closer than this, in cells, go through it."""


@dataclass(frozen=True)
class Wall:
    """Where a way ends at a wall.

    Attributes
    ----------
    share : float
        Share of the way that is open, in [0, 1].
    stops_x, stops_y : bool
        Which component of the motion the wall stops; a corner may stop both.
    cell : (column, row)
        The last cell of the way.
    at_edge : bool
        Whether the wall is the map's edge.
    """

    share: float
    stops_x: bool
    stops_y: bool
    cell: tuple[int, int]
    at_edge: bool


def first_wall(free: Bool[np.ndarray, "rows columns"], x: float, y: float, dx: float, dy: float) -> Wall | None:
    """Find the first wall on the straight way from (x, y) to (x + dx, y + dy), or None if all of it is open.

    A corner point is passed if the cell beyond it is free and at least one of its two side cells is. A way that ends
    on the border of a blocked cell ends at a wall.

    Parameters
    ----------
    free : (rows, columns) bool
        The map; row 0 is the lowest.
    x, y : float
        Where the way begins, in cells from the map's lower-left corner, inside of a free cell.
    dx, dy : float
        The way, in cells.
    """
    column, row = math.floor(x), math.floor(y)
    rows, columns = free.shape
    right, up = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    length = math.hypot(dx, dy)
    while True:
        to_x = (column + (dx > 0) - x) / dx if dx != 0 else math.inf
        to_y = (row + (dy > 0) - y) / dy if dy != 0 else math.inf
        share = max(0.0, min(to_x, to_y))
        if share > 1:
            return None
        here = (column, row)
        if abs(to_x - to_y) * length < CORNER_CELLS:
            beside, above = _is_free(free, column + right, row), _is_free(free, column, row + up)
            if not (_is_free(free, column + right, row + up) and (beside or above)):
                out = not (0 <= column + right < columns and 0 <= row + up < rows)
                return Wall(share, beside == above or not beside, beside == above or not above, here, out)
            column, row = column + right, row + up
        elif to_x < to_y:
            column += right
            if not _is_free(free, column, row):
                return Wall(share, True, False, here, not 0 <= column < columns)
        else:
            row += up
            if not _is_free(free, column, row):
                return Wall(share, False, True, here, not 0 <= row < rows)


def _is_free(free: Bool[np.ndarray, "rows columns"], column: int, row: int) -> bool:
    return 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and bool(free[row, column])
