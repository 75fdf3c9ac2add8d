"""Finite-horizon value iteration on alpha vectors, by incremental pruning.

``Γ_h`` from ``Γ_{h−1}``: for each action and observation the vectors are carried back over the step; their sums over
observations are made one observation at a time, and after each the set is made parsimonious (Cassandra, Littman, Zhang,
"Incremental pruning: a simple, fast, exact method for POMDPs", UAI 1997). One set for each class of states that the
agent can tell apart, so that vectors are as short, and sums as few, as can be. The number of vectors may grow doubly
exponentially with the horizon. When not to use it: more than a few dozen states in a class, or many observations.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from solvers.alpha_vectors import VectorSet
from solvers.base import Ability
from solvers.flat import FlatModel, can_flatten, flatten
from solvers.parsimonious import parsimonious
from solvers.policy import Stage, VectorPolicy
from solvers.solution import Clock, Limits, Progress, Solution

__all__ = ["Exact"]

_MOST_STATES = 2_000

Steps = dict[int, dict[int, list[tuple[int, np.ndarray]]]]
"""By class and action: for each thing that can be seen the class it leads to, and ``γ P(z, s' | s, a)``."""

Sets = dict[int, tuple[np.ndarray, np.ndarray]]
"""By class: vectors (K, n), and the actions (K,) that they begin with."""

Points = dict[int, np.ndarray]
"""By class: beliefs (P, n) where vectors were the best."""


class Exact:
    """The optimal value for every belief and every number of steps up to a horizon.

    Parameters
    ----------
    model : FactoredPOMDP
    """

    name = "exact"
    summary = "finite horizon, exact: alpha vectors by incremental pruning"
    limits = Limits

    def __init__(self, model: FactoredPOMDP) -> None:
        self.flat = flatten(model)
        self.steps = _steps(self.flat)

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where the flat tables fit and states are few enough for linear programs."""
        flat = can_flatten(model)
        if not flat or model.joint_states > _MOST_STATES:
            limit = flat.because if not flat else f"{flat.because}: more than {_MOST_STATES:,} states a vector"
            return Ability(False, limit, flat.estimate)
        first = f"up to {model.joint_actions ** (1 + min(model.joint_observations, 300)):.3g} vectors at 2 steps"
        return Ability(True, f"{flat.because}; needs a horizon", f"{flat.estimate}; {first} before pruning")

    def solve(self, limits: Limits) -> Solution:
        """Values with 1, 2, … steps to go; where time ends before the horizon, up to where it came.

        Raises
        ------
        ValueError
            Where no horizon is given.
        """
        if limits.horizon is None:
            raise ValueError(f"{self.name} needs a horizon: give the number of steps to plan for")
        clock = Clock(limits, self.flat)
        stages: list[Sets] = []
        points: Points = {}
        stopped = "solved"
        try:
            while len(stages) < limits.horizon:
                if stages and clock.is_over:
                    stopped = "time limit"
                    break
                stages.append(_backed_up(self.flat, self.steps, stages[-1] if stages else None, points, clock))
                self._tell(stages[-1], clock)
        except (KeyboardInterrupt, _Late) as end:
            if not stages:
                raise
            stopped = "time limit" if isinstance(end, _Late) else "interrupted"
        sets = tuple(Stage(VectorSet.of(self.flat, stage), None) for stage in stages)
        notes = () if stopped == "solved" else (f"{len(stages)} of {limits.horizon} steps to go",)
        policy = VectorPolicy(self.flat, self.name, sets, "lower bound", len(stages))
        return clock.solution(policy, stopped, notes)

    def _tell(self, stage: Sets, clock: Clock) -> None:
        if clock.limits.progress is not None:
            kind = self.flat.class_at(self.flat.initial)
            worth = VectorSet.of(self.flat, stage).best(self.flat.initial, kind or 0)[0]
            number = sum(len(actions) for _, actions in stage.values())
            clock.limits.progress(Progress(worth, worth, number, 0, clock.seconds))


class _Late(Exception):
    """The time was used up within a backup."""


def _steps(flat: FlatModel) -> Steps:
    """For each reached class and legal action: what can be seen leads to a class, by ``γ P(z, s' | s, a)``."""
    starts, tables = flat.tables.class_start, flat.tables
    found: Steps = {}
    waiting = [int(tables.class_of[np.flatnonzero(flat.initial)[0]])]
    columns = _columns(flat)
    while waiting:
        kind = waiting.pop()
        if kind in found:
            continue
        found[kind] = {}
        first, past = starts[kind], starts[kind + 1]
        for action in np.flatnonzero(tables.legal[:, first]):
            moves = flat.transition[action][first:past]
            after = np.unique(moves.indices)
            branches = []
            for column in np.unique(columns[action][after].indices):
                weights = moves.multiply(columns[action][:, [column]].toarray().ravel()[None, :]).tocsr()
                weights.eliminate_zeros()
                then = int(tables.class_of[weights.indices[0]])
                block = flat.discount * weights[:, starts[then] : starts[then + 1]].toarray()
                branches.append((then, block))
                waiting.append(then)
            found[kind][int(action)] = branches
    return found


def _columns(flat: FlatModel) -> list[Any]:
    """``P(z | s')`` with what is read back, as CSR arrays."""
    from scipy import sparse

    tables, states, actions = flat.tables, flat.size, len(flat.actions)
    whole = sparse.csr_array(
        (tables.seen_chance, tables.seen_column, tables.seen_start), shape=(actions * states, tables.columns)
    )
    return [whole[action * states : (action + 1) * states] for action in range(actions)]


def _backed_up(flat: FlatModel, steps: Steps, ahead: Sets | None, points: Points, clock: Clock) -> Sets:
    """One more step to go; ``points`` (by class) are replaced by beliefs where the new vectors are the best."""
    starts = flat.tables.class_start
    found: Sets = {}
    for kind, choices in steps.items():
        sets, names = [], []
        for action, branches in choices.items():
            reward = flat.reward[action, starts[kind] : starts[kind + 1]][None, :]
            vectors = reward if ahead is None else reward + _summed(branches, ahead, points.get(kind), clock)
            sets.append(vectors)
            names.append(np.full(len(vectors), action))
        together, actions = np.concatenate(sets), np.concatenate(names)
        kept, points[kind] = parsimonious(together, points.get(kind))
        found[kind] = together[kept], actions[kept]
    return found


def _summed(branches: list[tuple[int, np.ndarray]], ahead: Sets, points: np.ndarray | None, clock: Clock) -> np.ndarray:
    """Sums of one vector for each observation, parsimonious; the smallest sets come first."""
    sets = []
    for then, block in branches:
        carried = ahead[then][0] @ block.T
        kept, witnesses = parsimonious(carried, points)
        sets.append((carried[kept], witnesses))
    sets.sort(key=lambda pair: len(pair[0]))
    total, seen = sets[0]
    for further, witnesses in sets[1:]:
        if clock.is_over:
            raise _Late
        sums = (total[:, None, :] + further[None, :, :]).reshape(-1, total.shape[1])
        looked_at = [seen, witnesses] if points is None else [seen, witnesses, points]
        kept, seen = parsimonious(sums, np.vstack(looked_at))
        total = sums[kept]
    return total
