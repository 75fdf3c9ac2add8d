"""Where people would be after a while, if they moved as the model says: whether it draws them to walls and corners.

Targets that hardly turn follow a wall once they have met it, and with speeds below a cell a step they wait in front of
it. With the wall variant ``reject`` (model.md, "Motion on a grid") nothing sends them back before they turn by chance.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from surveillance_domain.model.motion import motion_tables
from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.prior import cells_of_half

__all__ = ["STEPS", "cells_after", "drawn_to_walls"]

STEPS = 100
_MOST_NUMBERS = 2_000_000
_TIMES_AS_MANY = 2


def cells_after(grid: Grid, parameters: MotionParameters, steps: int = STEPS) -> int:
    """The fewest cells in which half of the people are after some steps that began anywhere, in any direction.

    Time O(steps * cells * directions^2 * speeds). Those who left by a door do not count.
    """
    tables = motion_tables(grid, parameters)
    location, directions = tables.location, parameters.directions
    turning = tables.direction
    if turning.ndim == 2:
        turning = np.broadcast_to(turning, (grid.size, len(tables.speed), directions, directions))
    shape = turning.shape[:3]
    before = np.ravel_multi_index((location.cell, location.speed, location.direction), shape)
    after = np.ravel_multi_index((location.next_cell, location.speed, location.direction), shape)
    share = np.zeros(shape)
    share[: grid.size] = 1.0 / share[: grid.size].size
    for _ in range(steps):
        turned = np.matmul(np.einsum("lvd,vw->lwd", share, tables.speed)[:, :, None, :], turning).ravel()
        moved = np.bincount(after, turned[before] * location.probability, share.size)
        share = moved.astype(float).reshape(shape)
    return cells_of_half(share[: grid.size].sum(axis=(1, 2)))


def drawn_to_walls(grid: Grid, parameters: MotionParameters) -> tuple[int, int] | None:
    """Where half of the people are after `STEPS` steps, and where with ``reflect``, if that is many more cells.

    ``None`` where it is not, where walls reflect already, and where the model is too large to be run for a warning.
    """
    numbers = grid.size * parameters.directions**2 * len(parameters.speeds_mps)
    if parameters.walls == "reflect" or numbers > _MOST_NUMBERS:
        return None
    found, reflected = cells_after(grid, parameters), cells_after(grid, replace(parameters, walls="reflect"))
    return (found, reflected) if found * _TIMES_AS_MANY < reflected else None
