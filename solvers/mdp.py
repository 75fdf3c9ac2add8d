"""The model as if every state were seen: value iteration, and the linear program that must agree with it.

``V(s) = max_a R(a, s) + γ Σ P(s' | s, a) V(s')`` bounds every policy of the partially observable model from above.
Value iteration stops on the bounds of MacQueen and Porteus, and what it returns is shifted by what is left, so that it
is an upper bound whenever it stops. Time: sweeps over the entries of ``P(s' | s, a)``; memory: two numbers a state.
The linear program (cvxpy): minimise the sum of V subject to ``V ≥ R_a + γ P_a V``; small models only.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from jaxtyping import Float

from factored_pomdp.model import FactoredPOMDP
from solvers.base import Ability
from solvers.blind import blind_stages
from solvers.flat import FlatModel, can_flatten, flatten
from solvers.policy import Stage, VectorPolicy
from solvers.solution import Clock, Limits, Solution

__all__ = ["MDP", "linear_program", "state_values", "values_to_go"]

_MOST_SWEEPS = 1_000_000
_TOLERANCE = 1e-10


def state_values(flat: FlatModel) -> Float[np.ndarray, " states"]:
    """``V`` of the observed model over an infinite horizon, from above.

    Raises
    ------
    ValueError
        Where the discount is 1.
    """
    from solvers.sweeps import optimal_sweeps

    value = np.zeros(flat.size)
    tolerance = _TOLERANCE * max(1.0, float(np.abs(flat.reward).max()))
    _, high = optimal_sweeps(flat.tables, flat.tables.legal, value, _MOST_SWEEPS, tolerance)
    return value + flat.discount / (1 - flat.discount) * high


def linear_program(flat: FlatModel) -> Float[np.ndarray, " states"]:
    """``V`` of the observed model by linear programming."""
    import cvxpy

    value = cvxpy.Variable(flat.size)
    constraints = []
    for number, moves in enumerate(flat.transition):
        rows = np.flatnonzero(flat.tables.legal[number])
        if len(rows):
            ahead = flat.reward[number][rows] + flat.discount * (moves[rows] @ value)
            constraints.append(value[rows] >= ahead)
    problem = cvxpy.Problem(cvxpy.Minimize(np.ones(flat.size) @ value), constraints)
    problem.solve(solver=cvxpy.HIGHS)
    return np.asarray(value.value, dtype=float)


def values_to_go(flat: FlatModel, horizon: int) -> list[Float[np.ndarray, "actions states"]]:
    """``Q`` of the observed model with 1, 2, … steps to go."""
    from solvers.sweeps import action_values

    stages = [action_values(flat, np.zeros(flat.size))]
    while len(stages) < horizon:
        stages.append(action_values(flat, stages[-1].max(axis=0)))
    return stages


class MDP:
    """Upper bound, and the policy that acts as if the most probable state were the true one.

    Parameters
    ----------
    model : FactoredPOMDP
    method : str
        ``value-iteration`` or ``linear-program``.
    """

    name = "mdp"
    summary = "upper bound: as if every state were seen"
    limits = Limits

    def __init__(
        self, model: FactoredPOMDP, method: Literal["value-iteration", "linear-program"] = "value-iteration"
    ) -> None:
        self.flat, self.method = flatten(model), method

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where the flat tables fit."""
        return can_flatten(model)

    def solve(self, limits: Limits = Limits()) -> Solution:  # noqa: B008
        """The bound at the initial belief, with the value of the best blind policy below it."""
        clock = Clock(limits, self.flat)
        if limits.horizon is not None:
            upper = values_to_go(self.flat, limits.horizon)
        else:
            from solvers.sweeps import action_values

            value = state_values(self.flat) if self.method == "value-iteration" else linear_program(self.flat)
            upper = [action_values(self.flat, value)]
        lower = blind_stages(self.flat, limits.horizon)
        stages = tuple(Stage(low, high, per_state=True) for low, high in zip(lower, upper, strict=True))
        return clock.solution(VectorPolicy(self.flat, self.name, stages, "most probable state", limits.horizon))
