"""How well the learned model foretells moves that it has not seen, beside a random walk and a constant velocity.

All foretell the cell of the next position, as the filter needs it. The cell of the present position is known, but not
where in it a person stands: a displacement is shared among cells by overlapping area, as in model.md, "Motion on a
grid", and the log-likelihood is the mean of log P(cell) over these shares: the expectation over where the grid's lines
happen to fall. What a person does next is foretold from the last move alone:

``model``
    the velocity-direction model as it was learned, Gaussian in direction and speed about those of the last move (below
    0.25 m/s from any direction), integrated by quadrature;
``on_grid``
    the same as the filter has it, from the nearest direction bin and the nearest speed of the set;
``random_walk``, ``constant_velocity``
    a Gaussian in the plane about no move at all, or about the same move again.

With each, a share of 0.001 goes evenly to all cells in reach of the longest move: people run and stop as no model of
these says, and one such step would make the likelihood zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.model.motion_direction import direction_table, speed_table
from surveillance_domain.model.motion_location import move_shares
from surveillance_domain.trajectories.fitting import MotionFit
from surveillance_domain.trajectories.transitions import STILL_MPS, Transitions

__all__ = ["HeldOut", "check_grid_table", "held_out_log_likelihood", "verdict"]

_BACKGROUND = 1e-3
_TURN_NODES, _SPEED_NODES = 49, 25
_CHUNK = 500
_MOST_NUMBERS = 20_000_000


@dataclass(frozen=True)
class HeldOut:
    """Mean log-likelihoods in nats a step.

    Attributes
    ----------
    model, on_grid, random_walk, constant_velocity : float
    over_random_walk, over_constant_velocity : (float, float)
        95 % interval of the model's gain a step, with people as the independent units.
    steps, people : int
    impossible : float
        Share of steps of which some part ends in a cell that the model on the grid calls impossible.
    """

    model: float
    on_grid: float
    random_walk: float
    constant_velocity: float
    over_random_walk: tuple[float, float]
    over_constant_velocity: tuple[float, float]
    steps: int
    people: int
    impossible: float


def held_out_log_likelihood(fit: MotionFit, pairs: Transitions, cell_m: float, directions: int) -> HeldOut:
    """Judge a fit by pairs of moves that it was not made from.

    Parameters
    ----------
    fit : MotionFit
    pairs : Transitions
        At least one pair.
    cell_m : float
        Side of a cell in metres.
    directions : int
        How many directions the model on the grid has.

    Raises
    ------
    ValueError
        If there is no pair, the two have different steps, or the model on the grid would be too large.
    """
    if not len(pairs.people):
        raise ValueError("nobody who is held out takes two steps: there is nothing to judge the fit by")
    if pairs.step_s != fit.step_s:
        raise ValueError(f"a fit for steps of {fit.step_s:g} s cannot be judged by steps of {pairs.step_s:g} s")
    before, after = pairs.before_m / cell_m, pairs.after_m / cell_m
    reach = _reach(fit, pairs, cell_m)
    check_grid_table(fit, pairs, cell_m, directions)
    cells, shares = _landing(after, reach)
    table = _grid_model(fit, cell_m, directions, reach)
    on_grid = table[_state_of(fit, before, cell_m, directions)[:, None], cells[..., 0], cells[..., 1]]
    scores = {
        "model": _scores(_continuous_model(fit, before, cells - reach, cell_m), shares, reach),
        "on_grid": _scores(on_grid, shares, reach),
    }
    for name, centre, sigma_m in (
        ("random_walk", np.zeros_like(before), fit.random_walk_m),
        ("constant_velocity", before, fit.constant_velocity_m),
    ):
        x, y = (_axis_law(centre[:, axis], sigma_m / cell_m, cells[..., axis] - reach) for axis in (0, 1))
        scores[name] = _scores(x * y, shares, reach)
    gains = {name: scores["model"] - scores[name] for name in ("random_walk", "constant_velocity")}
    return HeldOut(
        **{name: float(score.mean()) for name, score in scores.items()},
        over_random_walk=_interval(gains["random_walk"], pairs.people),
        over_constant_velocity=_interval(gains["constant_velocity"], pairs.people),
        steps=len(pairs.people),
        people=len(np.unique(pairs.people)),
        impossible=float((((on_grid <= 0) & (shares > 1e-9)).any(axis=1)).mean()),
    )


def verdict(gain: tuple[float, float]) -> Literal["better", "worse", "undecided"]:
    """What a 95 % interval of the model's gain says of the model."""
    low, high = gain
    return "better" if low > 0 else "worse" if high < 0 else "undecided"


def _reach(fit: MotionFit, pairs: Transitions, cell_m: float) -> int:
    """Cells, along an axis, that the longest move can lead to."""
    longest = max(float(np.abs(pairs.after_m).max(initial=0.0)), max(fit.speeds_mps) * fit.step_s)
    return math.ceil(longest / cell_m) + 1


def check_grid_table(fit: MotionFit, pairs: Transitions, cell_m: float, directions: int) -> None:
    """Refuse a model on the grid that is too large, before anything of it is made.

    Raises
    ------
    ValueError
        With its size, and the cells that would do.
    """

    def numbers(side_m: float) -> int:
        return (directions + 1) * len(fit.speeds_mps) * (2 * _reach(fit, pairs, side_m) + 1) ** 2

    if numbers(cell_m) <= _MOST_NUMBERS:
        return
    enough = cell_m
    while numbers(enough) > _MOST_NUMBERS:
        enough *= 1.25
    window = 2 * _reach(fit, pairs, cell_m) + 1
    raise ValueError(
        f"cells of {cell_m:g} m: the model on the grid would be a table of {directions + 1} x {len(fit.speeds_mps)} x "
        f"{window:,} x {window:,} = {numbers(cell_m):.3g} numbers ({8e-9 * numbers(cell_m):,.1f} GB), the longest move "
        f"in {pairs.step_s:g} s going over {_reach(fit, pairs, cell_m) - 1:,} cells; at most {_MOST_NUMBERS:,} are "
        f"made: expected a --cell-m of about {_rounded_up(enough):g} or more"
    )


def _rounded_up(number: float) -> float:
    """To two digits."""
    unit = 10.0 ** (math.floor(math.log10(number)) - 1)
    return math.ceil(number / unit - 1e-9) * unit


def _landing(
    moves: Float[np.ndarray, "pairs 2"], reach: int
) -> tuple[Int[np.ndarray, "pairs 4 2"], Float[np.ndarray, "pairs 4"]]:
    """The four cells that a moved square overlaps, as indices into a window about the present cell, and its shares."""
    low = np.floor(moves)
    part = moves - low
    corners = np.array([(0, 0), (1, 0), (0, 1), (1, 1)])
    cells = low[:, None].astype(np.int64) + corners + reach
    along, up = (np.where(corners[:, axis] == 1, part[:, None, axis], 1 - part[:, None, axis]) for axis in (0, 1))
    return cells, along * up


def _continuous_model(
    fit: MotionFit, before: Float[np.ndarray, "pairs 2"], cells: Int[np.ndarray, "pairs 4 2"], cell_m: float
) -> Float[np.ndarray, "pairs 4"]:
    """P(cell): the moved square's share of it, averaged over nodes of turn and of speed; a speed below 0 is 0."""
    turns, turn_weights = _nodes(math.radians(fit.sigma_direction_deg), _TURN_NODES)
    around = (np.arange(_TURN_NODES) + 0.5) * 2 * np.pi / _TURN_NODES
    paces, pace_weights = _nodes(fit.sigma_speed_mps * fit.step_s / cell_m, _SPEED_NODES)
    lengths = np.hypot(*before.T)
    heading = np.arctan2(before[:, 1], before[:, 0])
    standing = lengths * cell_m / fit.step_s < STILL_MPS
    found = np.empty(cells.shape[:2])
    for start in range(0, len(before), _CHUNK):
        some = slice(start, start + _CHUNK)
        still = standing[some, None]
        angle = heading[some, None] + np.where(still, around, turns)
        weight = np.where(still, 1 / _TURN_NODES, turn_weights)[:, :, None] * pace_weights
        length = np.maximum(lengths[some, None, None] + paces, 0.0)
        x, y = np.cos(angle)[..., None] * length, np.sin(angle)[..., None] * length
        for corner in range(cells.shape[1]):
            column, row = (cells[some, corner, axis][:, None, None] for axis in (0, 1))
            share = np.maximum(1 - np.abs(x - column), 0.0) * np.maximum(1 - np.abs(y - row), 0.0)
            found[some, corner] = (share * weight).sum(axis=(1, 2))
    return found


def _nodes(sigma: float, count: int) -> tuple[Float[np.ndarray, " nodes"], Float[np.ndarray, " nodes"]]:
    """Evenly spaced points within four sigmas, and their weights under the Gaussian."""
    standard = np.linspace(-4.0, 4.0, count)
    weights = np.exp(-0.5 * standard**2)
    return sigma * standard, weights / weights.sum()


def _grid_model(
    fit: MotionFit, cell_m: float, directions: int, reach: int
) -> Float[np.ndarray, "states window window"]:
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


def _state_of(
    fit: MotionFit, before: Float[np.ndarray, "pairs 2"], cell_m: float, directions: int
) -> Int[np.ndarray, " pairs"]:
    """Row of `_grid_model` for each move."""
    pace = np.hypot(*before.T) * cell_m / fit.step_s
    speeds = np.asarray(fit.speeds_mps)
    nearest = np.abs(pace[:, None] - speeds).argmin(axis=1)
    bins = np.rint(np.arctan2(before[:, 1], before[:, 0]) / (2 * np.pi) * directions).astype(np.int64) % directions
    return np.where(pace < STILL_MPS, directions, bins) * len(speeds) + nearest


def _axis_law(
    centre: Float[np.ndarray, " pairs"], sigma: float, offsets: Int[np.ndarray, "pairs 4"]
) -> Float[np.ndarray, "pairs 4"]:
    """P(offset) along one axis of a unit square moved by N(centre, σ²): second differences of E(X - k)⁺, in cells."""
    low, middle, high = (_excess(centre[:, None] - (offsets + step), sigma) for step in (-1, 0, 1))
    return np.maximum(low - 2 * middle + high, 0.0)


def _excess(ahead: Float[np.ndarray, "pairs 4"], sigma: float) -> Float[np.ndarray, "pairs 4"]:
    """E(ahead + N(0, σ²))⁺."""
    from scipy.special import ndtr

    if sigma == 0:
        return np.maximum(ahead, 0.0)
    standard = ahead / sigma
    density = np.exp(-0.5 * standard**2) / math.sqrt(2 * math.pi)
    return np.asarray(sigma * (standard * ndtr(standard) + density))


def _scores(
    foretold: Float[np.ndarray, "pairs 4"], shares: Float[np.ndarray, "pairs 4"], reach: int
) -> Float[np.ndarray, " pairs"]:
    mixed = (1 - _BACKGROUND) * foretold + _BACKGROUND / (2 * reach + 1) ** 2
    return np.asarray((shares * np.log(mixed)).sum(axis=1))


def _interval(gains: Float[np.ndarray, " pairs"], people: Int[np.ndarray, " pairs"]) -> tuple[float, float]:
    """95 % interval of the mean, the steps of one person being as dependent as they like."""
    from scipy.stats import t

    mean = float(gains.mean())
    sums = np.bincount(people, weights=gains - mean)[np.unique(people)]
    if len(sums) < 2:
        return -math.inf, math.inf
    error = math.sqrt(float((sums**2).sum()) * len(sums) / (len(sums) - 1)) / len(gains)
    half = float(t.ppf(0.975, len(sums) - 1)) * error
    return mean - half, mean + half
