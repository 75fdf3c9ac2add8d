"""Finite horizons by the tree of all beliefs: the oracle of the exact solver.

``V_h(b) = max_a R_a · b + γ Σ_z V_{h−1}(P(z, · | b, a))`` over beliefs that are not normalised: V is positively
homogeneous, so the chance of an observation is the mass of what follows it. Straight from the expanded model, with
nothing shared with the alpha vectors. Time and memory: ``(|A| |Z|)^h`` beliefs; for small horizons.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from factored_pomdp.beliefs.plan import plan_of
from factored_pomdp.errors import TooLarge
from factored_pomdp.expansion import joint
from factored_pomdp.model import FactoredPOMDP

__all__ = ["tree_values"]

_MOST_NUMBERS = 50_000_000


def tree_values(
    model: FactoredPOMDP, horizon: int, belief: Float[np.ndarray, " states"] | None = None
) -> Float[np.ndarray, " actions"]:
    """What each joint action is worth first, with ``horizon`` steps to go; minus infinity where it is not legal.

    Parameters
    ----------
    belief : (N,) float, optional
        Over joint states, row-major; the initial belief if left out.

    Raises
    ------
    TooLarge
        Before the tree is made.
    """
    flat = joint(model)
    signs = _signs(model)
    branches = len(flat.actions) * sum(1 for _ in signs) * len(flat.observations)
    if branches ** (horizon - 1) * model.joint_states > _MOST_NUMBERS:
        raise TooLarge(
            f"the belief tree of {model.name} has up to {branches:,} beliefs a step, to the power of {horizon - 1}; "
            f"{_MOST_NUMBERS:,} numbers allowed"
        )
    steps = [
        [
            moves.toarray() * (views[:, [column]].toarray().ravel() * sign)
            for column in range(views.shape[1])
            for sign in signs
        ]
        for moves, views in zip(flat.transition, flat.observation, strict=True)
    ]
    root = (flat.initial if belief is None else belief)[None, :]
    return _values(root, horizon, np.array(steps), flat, _legal(model, flat.actions))[:, 0]


def _values(beliefs: np.ndarray, horizon: int, steps: np.ndarray, flat: Any, legal: np.ndarray) -> np.ndarray:
    """(A, B) values of each action at each belief."""
    worth = flat.reward @ beliefs.T
    allowed = np.stack([~(beliefs[:, ~row] > 0).any(axis=1) for row in legal])
    if horizon > 1:
        for action, branches in enumerate(steps):
            after = np.einsum("bs,zst->bzt", beliefs, branches).reshape(-1, beliefs.shape[1])
            ahead = _values(after, horizon - 1, steps, flat, legal).max(axis=0)
            worth[action] += flat.discount * ahead.reshape(len(beliefs), -1).sum(axis=1)
    return np.where(allowed, worth, -np.inf)


def _signs(model: FactoredPOMDP) -> list[np.ndarray]:
    """For each joint value of the variables that are read back after a step, where it holds."""
    read = sorted(model.declared_known & set(plan_of(model).structure.known))
    shape = [variable.size for variable in model.states]
    signs = [np.ones(model.joint_states)]
    for axis, variable in enumerate(model.states):
        if variable.name in read:
            at = np.unravel_index(np.arange(model.joint_states), shape)[axis]
            signs = [sign * (at == value) for sign in signs for value in range(variable.size)]
    return signs


def _legal(model: FactoredPOMDP, actions: list[dict[str, Any]]) -> Bool[np.ndarray, "actions states"]:
    shape = [variable.size for variable in model.states]
    rows = np.array(np.unravel_index(np.arange(model.joint_states), shape)).T
    states = [{v.name: v.values[int(i)] for v, i in zip(model.states, row, strict=True)} for row in rows]
    return np.array([[model.is_legal(action, state) for state in states] for action in actions])
