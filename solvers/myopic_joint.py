"""The paper's exponential solver, literally: expand, enumerate joint actions and joint observations, Bayes, reward.

``V(B, A) = Σ_Z R(B') P(Z | B, A)`` (eq:policy2) over joint states, with no use of independence: the oracle that the
decomposition is held against. Cost: O(|A| |Z|^m |T|^m |C|^n) a decision; memory: a few tables of |T|^m |C|^n numbers.
Use it to verify, never to control.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import Any

import numpy as np

from factored_pomdp.beliefs import JointBelief
from factored_pomdp.contraction import contract
from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import Factor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value
from solvers.base import Ability, Decision

__all__ = ["JointMyopic"]

_MOST_STATES = 5_000_000
_MOST_OPERATIONS = 200_000_000_000
_TIE = 1e-12


class JointMyopic:
    """Maximises the expected reward of the next step over a `JointBelief`.

    Parameters
    ----------
    model : FactoredPOMDP
    likelihood : mapping, optional
        Tables that stand in for observation distributions in the belief update and in P(Z | B, A), by observation
        variable; they need not sum to one (the paper's printed null observation does not).

    Raises
    ------
    TooLarge
        With the sizes, before anything is allocated.
    """

    name = "myopic-joint"
    summary = "one step ahead over joint states and observations; exponential"

    def __init__(self, model: FactoredPOMDP, likelihood: Mapping[str, Factor] | None = None) -> None:
        ability = self.can_solve(model)
        if not ability:
            raise TooLarge(f"{ability.because}; {ability.estimate}")
        self.model = model
        self.observation = {**model.observation, **(likelihood or {})}

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        states, actions, observations = model.joint_states, model.joint_actions, model.joint_observations
        operations = states * actions * observations
        sizes = f"{states:,} joint states, {actions:,} joint actions, {observations:,} joint observations"
        estimate = f"{operations:.3g} operations a decision, {8 * states:,} bytes a belief"
        if states > _MOST_STATES:
            return Ability(False, f"{sizes}: more than {_MOST_STATES:,} joint states", estimate)
        if operations > _MOST_OPERATIONS:
            return Ability(False, f"{sizes}: more than {_MOST_OPERATIONS:.0e} operations a decision", estimate)
        return Ability(True, sizes, estimate)

    def start(self) -> JointBelief:
        """The model's initial belief, in the form that `decide` takes."""
        return JointBelief.initial(self.model)

    def decide(self, belief: JointBelief, prefer: Mapping[str, Value] | None = None) -> Decision:
        """The best of all joint actions that are legal where the belief has mass; the first among equals."""
        values = {action: self.value(belief, dict(action)) for action in self._actions(belief)}
        best = max(values.values())
        tied = [action for action, value in values.items() if value >= best - _TIE * max(1.0, abs(best))]
        kept = [sum(prefer.get(n) == v for n, v in action) for action in tied] if prefer else [0] * len(tied)
        chosen = tied[int(np.argmax(kept))]
        return Decision(
            dict(chosen), values[chosen], best, f"enumeration of {len(values):,} joint actions, joint belief"
        )

    def value(self, belief: JointBelief, action: Mapping[str, Value]) -> float:
        """V(B, A) of eq:policy2, plus the part of the reward that reads the current state."""
        predicted = belief.predict(action)
        after = [variable.next for variable in self.model.states]
        mass = predicted.table.array_over(self.model.states)
        total = self._current(belief, action)
        rewards = [f.condition(action) for f in self.model.reward.values() if not self._reads_current(f)]
        columns = self._columns(action, after)
        for values in itertools.product(*(variable.values for variable in self.model.observations)):
            seen = dict(zip((variable.name for variable in self.model.observations), values, strict=True))
            unnormalised = mass
            for name, value in seen.items():
                unnormalised = unnormalised * columns[name][value]
            probability = float(unnormalised.sum())
            if probability > 0:
                posterior = unnormalised / probability
                expected = sum(float((posterior * r.condition(seen).array_over(after)).sum()) for r in rewards)
                total += expected * probability
        return total

    def _columns(self, action: Mapping[str, Value], after: list[Any]) -> dict[str, dict[Value, np.ndarray]]:
        """``P(z | S')`` for every observation variable and value, as arrays that broadcast over joint next states."""
        columns: dict[str, dict[Value, np.ndarray]] = {}
        for variable in self.model.observations:
            table = self.observation[variable.name].condition(action)
            columns[variable.name] = {v: table.condition({variable.name: v}).array_over(after) for v in variable.values}
        return columns

    def _reads_current(self, reward: Factor) -> bool:
        return any(variable in self.model.states for variable in reward.scope)

    def _current(self, belief: JointBelief, action: Mapping[str, Value]) -> float:
        """Expected reward of the terms that read the current state, over everything else that they read."""
        total = 0.0
        for reward in self.model.reward.values():
            if self._reads_current(reward):
                needed = self._ancestors(reward)
                total += float(
                    contract([f.condition(action) for f in (belief.table, *needed, reward)], []).dense().array
                )
        return total

    def _ancestors(self, reward: Factor) -> list[Factor]:
        """Distributions of the next states and observations that a reward reads, and of what they read."""
        found: dict[str, Factor] = {}
        waiting = [variable.name for variable in reward.scope]
        while waiting:
            name = waiting.pop()
            factor = self.observation.get(name) or (
                self.model.transition[name[:-5]] if name.endswith(".next") else None
            )
            if factor is not None and name not in found:
                found[name] = factor
                waiting += [variable.name for variable in factor.scope if variable.name != name]
        return list(found.values())

    def _actions(self, belief: JointBelief) -> list[tuple[tuple[str, Value], ...]]:
        names = [variable.name for variable in self.model.actions]
        listed = [
            tuple(zip(names, values, strict=True))
            for values in itertools.product(*(v.values for v in self.model.actions))
        ]
        if not self.model.legal:
            return listed
        known = sorted({v.name for f in self.model.legal.values() for v in f.scope if v in self.model.states})
        support = belief.marginal(*known).sparse()
        states = [
            {n: v.values[int(i)] for n, v, i in zip(known, support.scope, row, strict=True)}
            for row in support.coordinates
        ]
        return [action for action in listed if all(self.model.is_legal(dict(action), state) for state in states)]
