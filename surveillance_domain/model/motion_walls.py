"""Which moves between cells a map allows: the path of a move is the segment between the two cells' centres.

A move is lost if its path enters a blocked cell or leaves the map, or if it passes a corner point at which both side
cells are blocked. A path that goes exactly through a corner point does not enter the two side cells: with one of
them blocked it is allowed (a target may cut a single corner, but not slip between two blocks that touch).

All is exact integer arithmetic. A path is worked out once for an offset (dx, dy) and then laid over the whole map, so
the cost is O(offsets * longest move * cells) and nothing is quadratic in cells.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

__all__ = ["Path", "open_moves", "path_of"]

Cell = tuple[int, int]


@dataclass(frozen=True)
class Path:
    """What the segment from the centre of cell (0, 0) to the centre of another cell meets.

    Attributes
    ----------
    cells : tuple of (column, row)
        Every cell that is entered, the last included, the first not.
    corners : tuple of pairs of (column, row)
        The two side cells of each corner point that is passed.
    """

    cells: tuple[Cell, ...]
    corners: tuple[tuple[Cell, Cell], ...]


def path_of(dx: int, dy: int) -> Path:
    """Walk from border to border along the segment from (0, 0) to (dx, dy), cells being unit squares about integers.

    The k-th vertical border is crossed at the share (2k + 1) / (2 |dx|) of the way and the k-th horizontal one at
    (2k + 1) / (2 |dy|); both at once is a corner.
    """
    columns, rows = abs(dx), abs(dy)
    right, up = (1 if dx > 0 else -1), (1 if dy > 0 else -1)
    cells: list[Cell] = []
    corners: list[tuple[Cell, Cell]] = []
    column = row = 0
    while column < columns or row < rows:
        order = (2 * column + 1) * rows - (2 * row + 1) * columns
        if order == 0:
            corners.append((((column + 1) * right, row * up), (column * right, (row + 1) * up)))
        column, row = column + (order <= 0), row + (order >= 0)
        cells.append((column * right, row * up))
    return Path(tuple(cells), tuple(corners))


def open_moves(free: Bool[np.ndarray, "rows columns"], dx: int, dy: int) -> Bool[np.ndarray, "rows columns"]:
    """From which cells the move by (dx, dy) cells is open.

    Parameters
    ----------
    free : (rows, columns) bool
        The map; row 0 is the lowest.
    dx, dy : int
        The move in columns to the right and rows up.

    Returns
    -------
    (rows, columns) bool
        False also where the start itself is blocked.
    """
    if abs(dx) >= free.shape[1] or abs(dy) >= free.shape[0]:
        return np.zeros_like(free)
    path = path_of(dx, dy)
    allowed = free.copy()
    for cell in path.cells:
        allowed &= _shifted(free, *cell)
    for one, other in path.corners:
        allowed &= _shifted(free, *one) | _shifted(free, *other)
    return allowed


def _shifted(free: Bool[np.ndarray, "rows columns"], dx: int, dy: int) -> Bool[np.ndarray, "rows columns"]:
    """``free`` as seen from each cell at (dx, dy) cells away; outside of the map nothing is free."""
    rows, columns = free.shape
    seen = np.zeros_like(free)
    seen[max(0, -dy) : rows - max(0, dy), max(0, -dx) : columns - max(0, dx)] = free[
        max(0, dy) : rows + min(0, dy), max(0, dx) : columns + min(0, dx)
    ]
    return seen
