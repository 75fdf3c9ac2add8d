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
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.trajectories.fitting import MotionFit
from surveillance_domain.trajectories.on_grid import check_grid_model, grid_model, reach_of, state_of
from surveillance_domain.trajectories.open_floor import axis_law, velocity_direction_law
from surveillance_domain.trajectories.transitions import Transitions

__all__ = ["HeldOut", "held_out_log_likelihood", "verdict"]

_BACKGROUND = 1e-3


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


def held_out_log_likelihood(
    fit: MotionFit,
    pairs: Transitions,
    cell_m: float,
    directions: int,
    advance: Callable[[int], object] | None = None,
) -> HeldOut:
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
    advance : callable, optional
        Told how many more pairs are judged.

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
    reach = reach_of(fit, pairs, cell_m)
    check_grid_model(fit, pairs, cell_m, directions)
    cells, shares = _landing(after, reach)
    table = grid_model(fit, cell_m, directions, reach)
    on_grid = table[state_of(fit, before, cell_m, directions)[:, None], cells[..., 0], cells[..., 1]]
    scores = {
        "model": _scores(velocity_direction_law(fit, before, cells - reach, cell_m, advance), shares, reach),
        "on_grid": _scores(on_grid, shares, reach),
    }
    for name, centre, sigma_m in (
        ("random_walk", np.zeros_like(before), fit.random_walk_m),
        ("constant_velocity", before, fit.constant_velocity_m),
    ):
        x, y = (axis_law(centre[:, axis], sigma_m / cell_m, cells[..., axis] - reach) for axis in (0, 1))
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


def _scores(
    foretold: Float[np.ndarray, "pairs 4"], shares: Float[np.ndarray, "pairs 4"], reach: int
) -> Float[np.ndarray, " pairs"]:
    mixed = (1 - _BACKGROUND) * foretold + _BACKGROUND / (2 * reach + 1) ** 2
    return np.asarray((shares * np.log(mixed)).sum(axis=1))


def _interval(gains: Float[np.ndarray, " pairs"], people: Int[np.ndarray, " pairs"]) -> tuple[float, float]:
    """95 % interval of the mean, the steps of one person being as dependent as they like."""
    from scipy.special import stdtrit

    mean = float(gains.mean())
    sums = np.bincount(people, weights=gains - mean)[np.unique(people)]
    if len(sums) < 2:
        return -math.inf, math.inf
    error = math.sqrt(float((sums**2).sum()) * len(sums) / (len(sums) - 1)) / len(gains)
    half = float(stdtrit(len(sums) - 1, 0.975)) * error
    return mean - half, mean + half
