"""What models without a grid say of the next cell: the velocity-direction model, and a Gaussian about a point."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.trajectories.fitting import MotionFit
from surveillance_domain.trajectories.transitions import STILL_MPS

__all__ = ["axis_law", "velocity_direction_law"]

_TURN_NODES, _SPEED_NODES = 49, 25
_AT_ONCE = 20_000


def velocity_direction_law(
    fit: MotionFit,
    before: Float[np.ndarray, "pairs 2"],
    cells: Int[np.ndarray, "pairs 4 2"],
    cell_m: float,
    advance: Callable[[int], object] | None = None,
) -> Float[np.ndarray, "pairs 4"]:
    """P(cell): the moved square's share of it, averaged over nodes of turn and of speed; a speed below 0 is 0.

    Parameters
    ----------
    fit : MotionFit
    before : (pairs, 2) float
        Last moves, in cells.
    cells : (pairs, 4, 2) int
        Offsets, along both axes, from the present cell: of a cell, and of those to its right, above, above and right.
    cell_m : float
    advance : callable, optional
        Told how many more pairs are done.

    Notes
    -----
    Time O(pairs * nodes), some 10 microseconds a pair; memory O(pairs).
    """
    from surveillance_domain.trajectories.quadrature_kernel import add_overlaps

    turns, turn_weights = _nodes(math.radians(fit.sigma_direction_deg), _TURN_NODES)
    around = (np.arange(_TURN_NODES) + 0.5) * 2 * np.pi / _TURN_NODES
    even = np.full(_TURN_NODES, 1 / _TURN_NODES)
    paces, pace_weights = _nodes(fit.sigma_speed_mps * fit.step_s / cell_m, _SPEED_NODES)
    lengths = np.hypot(*before.T)
    heading = np.arctan2(before[:, 1], before[:, 0])
    standing = lengths * cell_m / fit.step_s < STILL_MPS
    found = np.zeros(cells.shape[:2])
    for start in range(0, len(before), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        low = cells[some, 0].astype(float)
        for which, angles, weights in ((~standing[some], turns, turn_weights), (standing[some], around, even)):
            add_overlaps(heading[some], lengths[some], which, low, angles, weights, paces, pace_weights, found[some])
        if advance is not None:
            advance(len(low))
    return found


def _nodes(sigma: float, count: int) -> tuple[Float[np.ndarray, " nodes"], Float[np.ndarray, " nodes"]]:
    """Evenly spaced points within four sigmas, and their weights under the Gaussian."""
    standard = np.linspace(-4.0, 4.0, count)
    weights = np.exp(-0.5 * standard**2)
    return sigma * standard, weights / weights.sum()


def axis_law(
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
