"""The value of the next step as a table over a block's states: many beliefs are valued by one matrix product.

V(B, a) is linear in each block's belief, ``Σ_k r_a · b_k`` plus what known variables and the action alone earn. The
vectors ``r_a`` are found by asking the one-step solver about beliefs that are certain of one state, once for each
assignment of the known variables that some table reads. Memory: joint actions × states of the blocks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.beliefs.plan import StackPlan, plan_of
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import count
from solvers.foresight.crowd import Crowd
from solvers.myopic import DecomposedMyopic

__all__ = ["OneStepTables", "tables_fit"]

_MOST_NUMBERS = 20_000_000
_MOST_STATES = 5_000
_MOST_TABLES = 500


def tables_fit(model: FactoredPOMDP) -> bool:
    """Whether the tables are small enough to be made; nothing is allocated to find out."""
    stacks = plan_of(model).stacks
    states = sum(count(plan.variables) * (1 if _alike(plan) else len(plan.stack.names)) for plan in stacks)
    return states <= _MOST_STATES and states * model.joint_actions <= _MOST_NUMBERS


@dataclass(frozen=True)
class _Table:
    """Values at one assignment of the known variables.

    Attributes
    ----------
    free : (actions,) float
    rewards : for each stack, (actions, states) float of each member, or one for all where they are alike
    """

    free: Float[np.ndarray, " actions"]
    rewards: list[list[Float[np.ndarray, "actions _"]]]


class OneStepTables:
    """V(B, ·) of every joint action for all beliefs of a crowd.

    The table for the known values at the start is made at once, so that no decision waits for it.

    Parameters
    ----------
    myopic : DecomposedMyopic
    """

    def __init__(self, myopic: DecomposedMyopic) -> None:
        model = myopic.model
        self._myopic, self._actions = myopic, model.actions
        factors = [*model.transition.values(), *model.observation.values(), *model.reward.values()]
        known = structure_of(model).known
        self._read = [name for name in known if any(name in factor.names for factor in factors)]
        self._tables: dict[tuple[int, ...], _Table] = {}
        self._table(Crowd.of(myopic.start(), 1))

    def values(self, crowd: Crowd) -> Float[np.ndarray, "actions scenarios"]:
        """Joint actions are numbered with the last variable changing fastest."""
        keys = np.array([np.zeros(crowd.scenarios, dtype=int), *(crowd.known[name] for name in self._read)])
        distinct, group = np.unique(keys, axis=1, return_inverse=True)
        values = np.empty((count(self._actions), crowd.scenarios))
        for number in range(distinct.shape[1]):
            inside = group.ravel() == number
            part = crowd.some(inside)
            values[:, inside] = self._valued(self._table(part), part)
        return values

    def _valued(self, table: _Table, crowd: Crowd) -> Float[np.ndarray, "actions scenarios"]:
        total: Any = table.free[:, None]
        for members, array, rewards in zip(crowd.stacks, crowd.arrays, table.rewards, strict=True):
            apart = array.reshape(len(array), crowd.scenarios, len(members))
            if len(rewards) == 1:
                total = total + rewards[0] @ (apart @ np.ones(len(members)))
            else:
                for column, reward in enumerate(rewards):
                    total = total + reward @ apart[:, :, column]
        return np.asarray(total)

    def _table(self, crowd: Crowd) -> _Table:
        key = tuple(int(crowd.known[name][0]) for name in self._read)
        if key not in self._tables:
            if len(self._tables) >= _MOST_TABLES:
                self._tables.clear()
            self._tables[key] = self._made(crowd.belief(0))
        return self._tables[key]

    def _made(self, belief: ProductBelief) -> _Table:
        nothing = [np.zeros_like(array) for array in belief.arrays]
        free = self._asked(belief.with_arrays(nothing))
        rewards = []
        for number, members in enumerate(belief.roster.stacks):
            columns = range(1 if _alike(members.plan) else len(members))
            rewards.append([self._of_states(belief, nothing, number, column) - free[:, None] for column in columns])
        return _Table(free, rewards)

    def _of_states(self, belief: ProductBelief, nothing: list[np.ndarray], stack: int, column: int) -> np.ndarray:
        """What each action earns where one block is known to be in each of its states, and no other has any mass."""
        found = []
        for state in range(len(nothing[stack])):
            certain = [array.copy() if number == stack else array for number, array in enumerate(nothing)]
            certain[stack][state, column] = 1.0
            found.append(self._asked(belief.with_arrays(certain)))
        return np.stack(found, axis=1)

    def _asked(self, belief: ProductBelief) -> Float[np.ndarray, " actions"]:
        total = np.zeros([variable.size for variable in self._actions])
        for function in self._myopic.local_functions(belief):
            total = total + function.array_over(self._actions)
        return total.ravel()


def _alike(plan: StackPlan) -> bool:
    """Whether all members earn the same in the same state, whatever is done."""
    return not plan.stack.own - {seen.name for seen in plan.seen}
