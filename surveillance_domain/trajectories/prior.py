"""Where people are: the prior over cells, counted from resampled positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.staging import Placement, nobody_on_map, on_free_cells

__all__ = ["MOST_CELLS", "CellPrior", "PlacedPrior", "cell_prior", "cells_of_half", "cells_over", "placed_prior"]

MOST_CELLS = 4_000_000


@dataclass(frozen=True, eq=False)
class CellPrior:
    """A prior over the cells of the rectangle that people were seen in.

    Attributes
    ----------
    origin_m : (float, float)
        Lower-left corner of the first cell, in the recording's frame.
    cell_m : float
    probability : (rows, columns) float
        Row 0 is the lowest; sums to one.
    """

    origin_m: tuple[float, float]
    cell_m: float
    probability: Float[np.ndarray, "rows columns"]


def cells_over(points_m: Float[np.ndarray, "points 2"], cell_m: float) -> tuple[int, int]:
    """Columns and rows of the rectangle of cells that points lie in."""
    low, high = (np.floor(end / cell_m) for end in (points_m.min(axis=0), points_m.max(axis=0)))
    columns, rows = (high - low + 1).tolist()
    return int(columns), int(rows)


def cell_prior(points_m: Float[np.ndarray, "points 2"], cell_m: float, smoothing: float = 0.5) -> CellPrior:
    """Share of the time that people spend in each cell, with ``smoothing`` visits to every cell added.

    Raises
    ------
    ValueError
        If the points spread over more than four million cells.
    """
    columns, rows = cells_over(points_m, cell_m)
    if columns * rows > MOST_CELLS:
        raise ValueError(f"people spread over {columns:,} x {rows:,} cells of {cell_m:g} m; give a larger --cell-m")
    low = np.floor(points_m.min(axis=0) / cell_m)
    cells = (np.floor(points_m / cell_m) - low).astype(np.int64)
    counts = np.bincount(cells[:, 1] * columns + cells[:, 0], minlength=rows * columns).reshape(rows, columns)
    weights = counts + smoothing
    return CellPrior((float(low[0] * cell_m), float(low[1] * cell_m)), cell_m, weights / weights.sum())


def cells_of_half(probability: Float[np.ndarray, "..."]) -> int:
    """The fewest cells in which people spend half of the time."""
    falling = np.sort(probability, axis=None)[::-1]
    return int(np.searchsorted(np.cumsum(falling), 0.5 * falling.sum())) + 1


@dataclass(frozen=True, eq=False)
class PlacedPrior:
    """A prior over the free cells of a site.

    Attributes
    ----------
    probability : (cells,) float
        Sums to one; above zero wherever people can walk from where they were seen.
    points : int
        Positions that were counted.
    off_map, in_walls : int
        Positions that were not: they fell off the map, or lay in walls, a cell or more from any free place.
    moved_out_of_walls : int
        Positions counted in the nearest free cell.
    out_of_reach : int
        Free cells that nobody can walk to: their probability is zero.
    """

    probability: Float[np.ndarray, " cells"]
    points: int
    off_map: int
    in_walls: int
    moved_out_of_walls: int
    out_of_reach: int


def placed_prior(
    points_m: Float[np.ndarray, "points 2"], grid: Grid, placement: Placement, smoothing: float = 0.5
) -> PlacedPrior:
    """Share of the time that people spend in each free cell of a site.

    ``smoothing`` visits are added to every free cell that people can walk to from a cell where they were seen, from one
    cell to the next over a side; so a prior from few people rules out no cell in which they can be.

    Raises
    ------
    ValueError
        If nobody ever is on the map.
    """
    placed = placement.placed(points_m)
    points, off_map, in_walls, moved = on_free_cells(placed, grid)
    numbers = grid.number_at(points[np.isfinite(points[:, 0])])
    if not len(numbers):
        raise nobody_on_map(placed, grid)
    counts = np.bincount(numbers, minlength=grid.size)
    reachable = _reachable(grid, counts)
    weights = counts + smoothing * reachable
    out_of_reach = int((~reachable).sum())
    return PlacedPrior(weights / weights.sum(), len(numbers), off_map, in_walls, moved, out_of_reach)


def _reachable(grid: Grid, counts: Int[np.ndarray, " cells"]) -> Bool[np.ndarray, " cells"]:
    """Free cells that hang together, over sides, with one in which somebody was."""
    from scipy.ndimage import label

    region = label(grid.free)[0][grid.free]
    return np.isin(region, np.unique(region[counts > 0]))
