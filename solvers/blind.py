"""Policies that never look: for each action the value of always choosing it (another where it is not legal).

They are the first lower bound of every other solver. Values are held from below: what value iteration leaves open is
taken off.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float, Int

from solvers.alpha_vectors import VectorSet
from solvers.flat import FlatModel

__all__ = ["blind_choices", "blind_stages", "blind_values"]

_MOST_SWEEPS = 1_000_000
_TOLERANCE = 1e-10


def blind_choices(flat: FlatModel) -> Int[np.ndarray, "actions states"]:
    """For each action what is chosen in each state: that action, or the first that is legal there."""
    legal = flat.tables.legal
    first = legal.argmax(axis=0)
    return np.stack([np.where(legal[action], action, first) for action in range(len(legal))])


def blind_values(flat: FlatModel) -> Float[np.ndarray, "actions states"]:
    """A lower bound of each blind policy's discounted value, over an infinite horizon."""
    from solvers.sweeps import optimal_sweeps

    tolerance = _TOLERANCE * max(1.0, float(np.abs(flat.reward).max()))
    rows = []
    for choice in blind_choices(flat):
        value = np.zeros(flat.size)
        low, _ = optimal_sweeps(flat.tables, _only(flat, choice), value, _MOST_SWEEPS, tolerance)
        rows.append(value + flat.discount / (1 - flat.discount) * low)
    return np.stack(rows)


def blind_stages(flat: FlatModel, horizon: int | None) -> list[VectorSet]:
    """Blind policies as alpha vectors: one set, or one for each number of steps to go."""
    from solvers.sweeps import optimal_sweeps

    choices = blind_choices(flat)
    if horizon is None:
        return [VectorSet.everywhere(flat, blind_values(flat), choices)]
    stages, values = [], np.zeros(choices.shape)
    for _ in range(horizon):
        for choice, value in zip(choices, values, strict=True):
            optimal_sweeps(flat.tables, _only(flat, choice), value, 1, 0.0)
        stages.append(VectorSet.everywhere(flat, values.copy(), choices))
    return stages


def _only(flat: FlatModel, choice: Int[np.ndarray, " states"]) -> Bool[np.ndarray, "actions states"]:
    """The choice of each state as what alone is legal there."""
    return np.asarray(np.arange(len(flat.actions))[:, None] == choice)
