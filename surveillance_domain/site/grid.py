"""The planning grid: which cells are free, how they are numbered, and where they lie in metres.

Frame: x to the right, y up, in metres. A cell is named ``(column, row)`` from the lower left; row 0 is the lowest.
Free cells are numbered in row-major order (row 0 first, columns left to right); blocked cells have no number.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int

__all__ = ["Grid"]


@dataclass(frozen=True, eq=False)
class Grid:
    """A raster of free and blocked cells.

    Attributes
    ----------
    free : (rows, columns) bool
        ``free[row, column]``; row 0 is the lowest.
    cell_m : float
        Side of a cell in metres.
    origin_m : (float, float)
        x and y, in metres, of the lower-left corner of cell (0, 0).
    """

    free: Bool[np.ndarray, "rows columns"]
    cell_m: float
    origin_m: tuple[float, float] = (0.0, 0.0)

    @property
    def rows(self) -> int:
        return int(self.free.shape[0])

    @property
    def columns(self) -> int:
        return int(self.free.shape[1])

    @cached_property
    def cells(self) -> Int[np.ndarray, "cells 2"]:
        """``(column, row)`` of every free cell, in the order of their numbers."""
        row, column = np.nonzero(self.free)
        return np.stack([column, row], axis=1)

    @cached_property
    def number(self) -> Int[np.ndarray, "rows columns"]:
        """Number of the free cell at ``[row, column]``, -1 where it is blocked."""
        numbers = np.full(self.free.shape, -1, dtype=np.int64)
        numbers[self.free] = np.arange(int(self.free.sum()))
        return numbers

    @cached_property
    def centres_m(self) -> Float[np.ndarray, "cells 2"]:
        """Centre of every free cell in metres."""
        return (self.cells + 0.5) * self.cell_m + np.asarray(self.origin_m)

    @property
    def size(self) -> int:
        """How many cells are free."""
        return len(self.cells)

    def cell_at(self, point_m: Float[np.ndarray, "... 2"]) -> Int[np.ndarray, "... 2"]:
        """``(column, row)`` of the cell that holds a point, in metres; it may lie outside of the map."""
        return np.floor((np.asarray(point_m) - np.asarray(self.origin_m)) / self.cell_m).astype(np.int64)

    def number_at(self, point_m: Float[np.ndarray, "... 2"]) -> Int[np.ndarray, "..."]:
        """Number of the free cell that holds a point, in metres; -1 if it is blocked or outside."""
        cell = self.cell_at(point_m)
        column, row = cell[..., 0], cell[..., 1]
        inside = (column >= 0) & (column < self.columns) & (row >= 0) & (row < self.rows)
        return np.where(inside, self.number[np.clip(row, 0, self.rows - 1), np.clip(column, 0, self.columns - 1)], -1)

    @classmethod
    def from_rows(cls, rows: list[str], cell_m: float, origin_m: tuple[float, float] = (0.0, 0.0)) -> Grid:
        """A grid drawn as text, top row first, ``#`` blocked and ``.`` free."""
        return cls(np.array([[mark != "#" for mark in row] for row in reversed(rows)]), cell_m, origin_m)
