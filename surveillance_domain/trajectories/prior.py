"""Where people are: the prior over cells, counted from resampled positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

__all__ = ["CellPrior", "cell_prior"]

_MOST_CELLS = 4_000_000


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


def cell_prior(points_m: Float[np.ndarray, "points 2"], cell_m: float, smoothing: float = 0.5) -> CellPrior:
    """Share of the time that people spend in each cell, with ``smoothing`` visits to every cell added.

    Raises
    ------
    ValueError
        If the points spread over more than four million cells.
    """
    low = np.floor(points_m.min(axis=0) / cell_m)
    cells = (np.floor(points_m / cell_m) - low).astype(np.int64)
    columns, rows = (cells.max(axis=0) + 1).tolist()
    if columns * rows > _MOST_CELLS:
        raise ValueError(f"people spread over {columns:,} x {rows:,} cells of {cell_m:g} m; give a larger --cell-m")
    counts = np.bincount(cells[:, 1] * columns + cells[:, 0], minlength=rows * columns).reshape(rows, columns)
    weights = counts + smoothing
    return CellPrior((float(low[0] * cell_m), float(low[1] * cell_m)), cell_m, weights / weights.sum())
