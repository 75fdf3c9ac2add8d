"""The numbers of the motion model (eq:targettransmodel), learned from pairs of successive moves.

σ of the direction is the maximum-likelihood estimate of a wrapped Gaussian about no turn (model.md, "Motion on a
grid"), over pairs in which the person walks; σ of the speed the root mean square of its changes; the set of speeds are
the centres of a K-means clustering of all speeds, started at quantiles, so without chance.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.trajectories.transitions import Transitions

__all__ = ["MotionFit", "fit_motion", "speed_set", "wrapped_gaussian_sigma"]

_LEAST_RAD = 1e-4
_MOST_RAD = 2 * math.pi
_TAILS = 9.0
_AT_ONCE = 250_000


@dataclass(frozen=True)
class MotionFit:
    """What was learned.

    Attributes
    ----------
    sigma_direction_deg : float
        Of the change of direction in one step, in degrees.
    sigma_speed_mps : float
        Of the change of speed in one step, in metres a second.
    speeds_mps : tuple of float
        Rising.
    mean_speed_mps : float
        Of all moves.
    step_s : float
        The step for which the sigmas hold.
    random_walk_m, constant_velocity_m : float
        Standard deviation, along each axis, of a displacement and of its change: the two rival models.
    """

    sigma_direction_deg: float
    sigma_speed_mps: float
    speeds_mps: tuple[float, ...]
    mean_speed_mps: float
    step_s: float
    random_walk_m: float
    constant_velocity_m: float


def fit_motion(pairs: Transitions, speeds: int = 3) -> MotionFit:
    """Learn the motion model's numbers.

    Parameters
    ----------
    pairs : Transitions
    speeds : int
        How many speeds the set is to hold; fewer where the data has fewer.

    Raises
    ------
    ValueError
        If nobody walks two steps on end.
    """
    turns = pairs.turns_rad
    if not turns.size:
        raise ValueError(
            f"nobody walks two steps of {pairs.step_s:g} s on end: there is no direction to learn; "
            "give a shorter --step-s, or longer tracks"
        )
    return MotionFit(
        sigma_direction_deg=math.degrees(wrapped_gaussian_sigma(turns)),
        sigma_speed_mps=_root_mean_square(pairs.speed_changes_mps),
        speeds_mps=speed_set(pairs.moves_mps, speeds),
        mean_speed_mps=float(pairs.moves_mps.mean()),
        step_s=pairs.step_s,
        random_walk_m=_root_mean_square(pairs.after_m),
        constant_velocity_m=_root_mean_square(pairs.after_m - pairs.before_m),
    )


def _root_mean_square(values: Float[np.ndarray, "..."]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def wrapped_gaussian_sigma(turns_rad: Float[np.ndarray, " turns"]) -> float:
    """Maximum-likelihood σ, in radians, of a Gaussian about 0 that is wound about the circle.

    A σ above a full turn cannot be told from the uniform distribution; it is the largest answer.
    """
    from scipy.optimize import minimize_scalar

    def cost(log_sigma: float) -> float:
        sigma = math.exp(log_sigma)
        wraps = math.ceil((math.pi + _TAILS * sigma) / (2 * math.pi))  # what is further away adds nothing
        told = 0.0
        for start in range(0, len(turns_rad), _AT_ONCE):
            some = turns_rad[start : start + _AT_ONCE, None]
            exponents = -0.5 * ((some + 2 * math.pi * np.arange(-wraps, wraps + 1)) / sigma) ** 2
            largest = exponents.max(axis=1)
            told += float((largest + np.log(np.exp(exponents - largest[:, None]).sum(axis=1))).sum())
        return len(turns_rad) * log_sigma - told

    if float(np.abs(turns_rad).max()) < _LEAST_RAD:
        return _root_mean_square(turns_rad)
    found = minimize_scalar(
        cost, bounds=(math.log(_LEAST_RAD), math.log(_MOST_RAD)), method="bounded", options={"xatol": 1e-7}
    )
    return math.exp(float(found.x))


def speed_set(moves_mps: Float[np.ndarray, " moves"], count: int) -> tuple[float, ...]:
    """Centres of ``count`` clusters of speeds, rising; fewer where speeds (to 1 mm/s) or clusters are fewer."""
    from scipy.cluster.vq import kmeans

    different = np.unique(moves_mps.round(3))
    count = min(count, len(different))
    if count == len(different):
        return tuple(different.tolist())
    if count == 1:  # kmeans would take a single centre for a number of clusters
        return (round(float(moves_mps.mean()), 3),)
    start = np.unique(np.quantile(moves_mps, (np.arange(count) + 0.5) / count))
    if len(start) < count:
        start = different[np.linspace(0, len(different) - 1, count).round().astype(int)]
    centres, _ = kmeans(moves_mps[:, None], start[:, None])
    return tuple(sorted(set(centres[:, 0].round(3).tolist())))
