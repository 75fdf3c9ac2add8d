"""Both bounds of a policy along the beliefs of a problem with two states, as a picture shows them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from solvers.policy import VectorPolicy

__all__ = ["TwoStates", "two_states"]

_POINTS = 501


@dataclass(frozen=True, eq=False)
class TwoStates:
    """A value function over one probability.

    Attributes
    ----------
    axis : str
        The state whose probability it is.
    vectors : (K, 2) float
        Alpha vectors: worth where the probability is 0, and where it is 1.
    actions : (K,) int
        The action that each begins with.
    names : tuple of str
        Of all actions.
    probabilities, lower, upper : (P,) float
        Bounds along the axis; the upper one is convex, as the optimal value is.
    """

    axis: str
    vectors: Float[np.ndarray, "vectors 2"]
    actions: Int[np.ndarray, " vectors"]
    names: tuple[str, ...]
    probabilities: Float[np.ndarray, " points"]
    lower: Float[np.ndarray, " points"]
    upper: Float[np.ndarray, " points"]


def two_states(policy: VectorPolicy) -> TwoStates:
    """What is to be seen of a policy with its whole horizon to go.

    Raises
    ------
    ValueError
        Where the model has not two states, or they can be told apart.
    """
    flat = policy.flat
    if flat.size != 2 or len(flat.tables.class_start) != 2:
        told = "" if flat.size != 2 else " that can be told apart"
        raise ValueError(f"{flat.model.name} has {flat.size:,} states{told}; expected two that are not seen")
    vectors, actions = policy.stage().lower.of_class(0)
    probabilities = np.linspace(0, 1, _POINTS)
    bounds = np.array([policy.bounds(np.array([1 - p, p])) for p in probabilities])
    shape = [variable.size for variable in flat.model.states]
    indexes = np.unravel_index(int(flat.order[1]), shape)
    values = zip(flat.model.states, indexes, strict=True)
    axis = ", ".join(f"{v.name} = {v.values[int(i)]}" for v, i in values if v.size > 1)
    names = tuple(", ".join(str(value) for value in action.values()) for action in flat.actions)
    return TwoStates(axis, vectors, actions, names, probabilities, bounds[:, 0], _below(probabilities, bounds[:, 1]))


def _below(places: Float[np.ndarray, " points"], upper: Float[np.ndarray, " points"]) -> Float[np.ndarray, " points"]:
    """The largest convex function that is nowhere above: a bound too, as the optimal value is convex."""
    corners: list[int] = []
    for new in range(len(places)):
        while len(corners) > 1:
            before, last = corners[-2:]
            slope = (upper[last] - upper[before]) / (places[last] - places[before])
            if upper[new] > upper[before] + slope * (places[new] - places[before]):
                break
            corners.pop()
        corners.append(new)
    return np.interp(places, places[corners], upper[corners])
