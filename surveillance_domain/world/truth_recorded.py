"""Recorded people in place of simulated targets: positions as they were, in metres.

A person's direction and speed are those of the move that led to the present position or, where there was none, of the
next one. The belief stays on the grid; nothing of the filter's motion code is imported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["RecordedTruth"]


@dataclass(frozen=True, eq=False)
class RecordedTruth:
    """Where recorded people are at one time step.

    Attributes
    ----------
    path_m : (times, targets, 2) float
        Positions at all times, on free cells; nan while a target is outside. After the last time everybody is outside.
    grid : Grid
    parameters : MotionParameters
        Only the directions, the speeds and the step are read.
    time : int
        Steps since the beginning.
    """

    path_m: Float[np.ndarray, "times targets 2"]
    grid: Grid
    parameters: MotionParameters
    time: int = 0

    @property
    def positions_m(self) -> Float[np.ndarray, "targets 2"]:
        """Where each target is, x and y in metres; nan while it is outside."""
        return self._at(self.time)

    @property
    def cells(self) -> Int[np.ndarray, "targets"]:
        """Number of the free cell each target is in, or `OUTSIDE`."""
        inside = np.isfinite(self.positions_m[:, 0])
        return np.where(inside, self.grid.number_at(np.where(inside[:, None], self.positions_m, 0.0)), OUTSIDE)

    @property
    def directions(self) -> Int[np.ndarray, "targets"]:
        """Direction bin nearest to the last move (0 for a target without one)."""
        dx, dy = self._moves().T
        bins = self.parameters.directions
        return np.rint(np.arctan2(dy, dx) / math.tau * bins).astype(np.int64) % bins

    @property
    def speeds(self) -> Int[np.ndarray, "targets"]:
        """Index of the speed of the set that is nearest to the last move's."""
        pace = np.hypot(*self._moves().T) / self.parameters.step_s
        return np.abs(pace[:, None] - np.asarray(self.parameters.speeds_mps)).argmin(axis=1)

    def step(self) -> RecordedTruth:
        """One time step later."""
        return replace(self, time=self.time + 1)

    def _at(self, time: int) -> Float[np.ndarray, "targets 2"]:
        if 0 <= time < len(self.path_m):
            return self.path_m[time]
        return np.full(self.path_m.shape[1:], np.nan)

    def _moves(self) -> Float[np.ndarray, "targets 2"]:
        before, now, after = (self._at(self.time + shift) for shift in (-1, 0, 1))
        moved = np.where(np.isfinite(before), now - before, after - now)
        return np.where(np.isfinite(moved), moved, 0.0)
