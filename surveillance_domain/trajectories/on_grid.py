"""The learned model as the filter has it: on the grid, from the nearest direction bin and the nearest speed."""

from __future__ import annotations

import math

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.model.motion_direction import direction_table, speed_table
from surveillance_domain.model.motion_location import move_shares
from surveillance_domain.trajectories.fitting import MotionFit
from surveillance_domain.trajectories.transitions import STILL_MPS, Transitions

__all__ = ["check_grid_model", "grid_model", "reach_of", "state_of"]

_MOST_NUMBERS = 20_000_000


def reach_of(fit: MotionFit, pairs: Transitions, cell_m: float) -> int:
    """Cells, along an axis, that the longest move can lead to."""
    longest = max(float(np.abs(pairs.after_m).max(initial=0.0)), max(fit.speeds_mps) * fit.step_s)
    return math.ceil(longest / cell_m) + 1


def check_grid_model(fit: MotionFit, pairs: Transitions, cell_m: float, directions: int) -> None:
    """Refuse a model on the grid that is too large, before anything of it is made.

    Raises
    ------
    ValueError
        With its size, and the cells that would do.
    """

    def numbers(side_m: float) -> int:
        return (directions + 1) * len(fit.speeds_mps) * (2 * reach_of(fit, pairs, side_m) + 1) ** 2

    if numbers(cell_m) <= _MOST_NUMBERS:
        return
    enough = cell_m
    while numbers(enough) > _MOST_NUMBERS:
        enough *= 1.05
    window = 2 * reach_of(fit, pairs, cell_m) + 1
    raise ValueError(
        f"cells of {cell_m:g} m: the model on the grid would be a table of {directions + 1} x {len(fit.speeds_mps)} x "
        f"{window:,} x {window:,} = {numbers(cell_m):.3g} numbers ({8e-9 * numbers(cell_m):,.1f} GB), the longest move "
        f"in {pairs.step_s:g} s going over {reach_of(fit, pairs, cell_m) - 1:,} cells; at most {_MOST_NUMBERS:,} are "
        f"made: expected a --cell-m of about {_rounded_up(enough):g} or more"
    )


def _rounded_up(number: float) -> float:
    """To two digits."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.ceil(number / unit - 1e-9) * unit


def grid_model(fit: MotionFit, cell_m: float, directions: int, reach: int) -> Float[np.ndarray, "states window window"]:
    """P(cell | state) in the open, for every direction and speed and, last, for a person who stands, by speed."""
    window = np.zeros((directions, len(fit.speeds_mps), 2 * reach + 1, 2 * reach + 1))
    for heading in range(directions):
        for number, speed in enumerate(fit.speeds_mps):
            move = move_shares(speed * fit.step_s / cell_m, heading * 360.0 / directions)
            for (dx, dy), share in zip(move.offsets, move.shares, strict=True):
                window[heading, number, dx + reach, dy + reach] += share
    turning = direction_table(directions, fit.sigma_direction_deg)
    changing = speed_table(fit.speeds_mps, fit.sigma_speed_mps)
    table = np.einsum("de,vw,ewxy->dvxy", turning, changing, window)
    standing = table.mean(axis=0, keepdims=True)
    return np.concatenate([table, standing]).reshape(-1, *table.shape[2:])


def state_of(
    fit: MotionFit, before: Float[np.ndarray, "pairs 2"], cell_m: float, directions: int
) -> Int[np.ndarray, " pairs"]:
    """Row of `grid_model` for each move."""
    pace = np.hypot(*before.T) * cell_m / fit.step_s
    speeds = np.asarray(fit.speeds_mps)
    nearest = np.abs(pace[:, None] - speeds).argmin(axis=1)
    bins = np.rint(np.arctan2(before[:, 1], before[:, 0]) / (2 * np.pi) * directions).astype(np.int64) % directions
    return np.where(pace < STILL_MPS, directions, bins) * len(speeds) + nearest
