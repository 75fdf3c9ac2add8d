"""The paper's exponential solver, literally: expand, enumerate joint actions and joint observations, Bayes, reward.

``V(B, A) = Σ_Z R(B') P(Z | B, A)`` (eq:policy2) over joint states, with no use of independence: the oracle that the
decomposition is held against. Cost: O(|A| |Z|^m |T|^m |C|^n) a decision; memory: a few tables of |T|^m |C|^n numbers.
Use it to verify, never to control.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from functools import reduce

import numpy as np

from factored_pomdp.beliefs import JointBelief
from factored_pomdp.contraction import contract
from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import Factor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import Value, Variable, count
from solvers.base import Ability, Decision

__all__ = ["JointMyopic"]

_MOST_STATES = 5_000_000
_MOST_OPERATIONS = 200_000_000_000
_MOST_AT_ONCE = 5_000_000
_TIE = 1e-12

Action = dict[str, Value]


class JointMyopic:
    """Maximises the expected reward of the next step over a `JointBelief`, given that the episode goes on.

    Parameters
    ----------
    model : FactoredPOMDP
    likelihood : mapping, optional
        Tables that stand in for observation distributions in the belief update and in P(Z | B, A), by observation
        variable; they need not sum to one (the paper's printed null observation does not).
    sparse : bool
        Whether beliefs hold only the joint states that have mass (`JointBelief` in its sparse form): known variables
        then cost nothing.

    Raises
    ------
    TooLarge
        With the sizes, before anything is allocated.
    """

    name = "myopic-joint"
    summary = "one step ahead over joint states and observations; exponential"

    def __init__(
        self, model: FactoredPOMDP, likelihood: Mapping[str, Factor] | None = None, sparse: bool = False
    ) -> None:
        ability = self.can_solve(model, sparse)
        if not ability:
            raise TooLarge(f"{ability.because}; {ability.estimate}")
        self.model, self.sparse = model, sparse
        self.observation = {**model.observation, **(likelihood or {})}
        self._now = {variable.next.name: variable.name for variable in model.states}
        self._tables: dict[tuple[Value, ...], Factor] = {}

    @classmethod
    def can_solve(cls, model: FactoredPOMDP, sparse: bool = False) -> Ability:
        """Whether the joint tables fit, and the number of operations is bearable; the sizes are told either way."""
        states, actions, observations = model.joint_states, model.joint_actions, model.joint_observations
        held = states
        if sparse:
            known = structure_of(model).known
            held = count(variable for variable in model.states if variable.name not in known)
        operations = held * actions * observations
        sizes = f"{states:,} joint states, {actions:,} joint actions, {observations:,} joint observations"
        if sparse:
            sizes += f", up to {held:,} joint states with mass"
        estimate = f"{operations:.3g} operations a decision, {8 * held:,} bytes a belief"
        if held > _MOST_STATES:
            return Ability(False, f"{sizes}: more than {_MOST_STATES:,} joint states to hold", estimate)
        if operations > _MOST_OPERATIONS:
            return Ability(False, f"{sizes}: more than {_MOST_OPERATIONS:.0e} operations a decision", estimate)
        return Ability(True, sizes, estimate)

    def start(self) -> JointBelief:
        """The model's initial belief, in the form that `decide` takes."""
        return JointBelief.initial(self.model, self.sparse)

    def decide(self, belief: JointBelief, prefer: Mapping[str, Value] | None = None) -> Decision:
        """The best of all joint actions that are legal where the belief has mass; the first among equals."""
        valued = self.values(belief)
        best = max(value for _, value in valued)
        tied = [(a, value) for a, value in valued if value >= best - _TIE * max(1.0, abs(best))]
        kept = [sum(prefer.get(n) == v for n, v in action.items()) for action, _ in tied] if prefer else [0]
        chosen, value = tied[int(np.argmax(kept))]
        return Decision(chosen, value, best, f"enumeration of {len(valued):,} joint actions, joint belief")

    def values(self, belief: JointBelief) -> list[tuple[Action, float]]:
        """Every joint action that is legal where the belief has mass, and what it is worth."""
        going_on = belief.running()
        return [(action, self.value(going_on, action)) for action in self._actions(going_on)]

    def value(self, belief: JointBelief, action: Mapping[str, Value]) -> float:
        """V(B, A) of eq:policy2, plus the part of the reward that reads the current state."""
        belief = belief.running()
        predicted = belief.predict(action).table
        ahead = [reward for reward in self.model.reward.values() if not self._reads_current(reward)]
        rewards = [reward.condition(action).renamed(self._now) for reward in ahead]
        tables = {variable.name: self._table(variable, action) for variable in self.model.observations}
        one_by_one, at_once = self._split(tables, rewards)
        columns = {v.name: {value: tables[v.name].condition({v.name: value}) for value in v.values} for v in one_by_one}
        rest = [tables[variable.name] for variable in at_once]
        total = self._current(belief, action)
        for values in itertools.product(*(variable.values for variable in one_by_one)):
            seen = dict(zip((variable.name for variable in one_by_one), values, strict=True))
            unnormalised = predicted
            for name, value in seen.items():
                unnormalised = unnormalised.product(columns[name][value])
            total += _expected(unnormalised, rest, [reward.condition(seen) for reward in rewards], at_once)
        return total

    def _table(self, variable: Variable, action: Mapping[str, Value]) -> Factor:
        """``P(z | S', A)`` of one observation variable, laid out once for each action that it reads."""
        factor = self.observation[variable.name]
        key = (variable.name, *(action.get(name) for name in factor.names))
        if key not in self._tables:
            table = factor.condition(action).renamed(self._now)
            self._tables[key] = table.dense() if table.size <= _MOST_AT_ONCE else table.sparse()
        return self._tables[key]

    def _split(
        self, tables: Mapping[str, Factor], rewards: Sequence[Factor]
    ) -> tuple[list[Variable], tuple[Variable, ...]]:
        """Observation variables to enumerate one by one, and the last one, all of whose values fit into one array."""
        *first, last = self.model.observations or (None,)
        if last is None:
            return [], ()
        sizes = [count({*tables[last.name].scope, *reward.scope} - set(first)) for reward in rewards]
        if max(sizes, default=0) > _MOST_AT_ONCE:
            return [*first, last], ()
        return first, (last,)

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

    def _actions(self, belief: JointBelief) -> list[Action]:
        names = [variable.name for variable in self.model.actions]
        listed = [
            dict(zip(names, values, strict=True))
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
        return [action for action in listed if all(self.model.is_legal(action, state) for state in states)]


def _expected(
    unnormalised: Factor, tables: Sequence[Factor], rewards: Sequence[Factor], seen: tuple[Variable, ...]
) -> float:
    """``Σ_z R(B') P(z | B, A)`` over the values of ``seen``; of B' only what a reward reads is kept.

    Parameters
    ----------
    unnormalised : Factor
        ``P(S', other observations | B, A)`` over joint next states.
    tables : sequence of Factor
        ``P(z | S')`` of the variables in ``seen``.
    rewards : sequence of Factor
        Over next states and ``seen``.
    """
    total = 0.0
    joints: dict[frozenset[Variable], tuple[list[Variable], np.ndarray]] = {}
    for reward in rewards:
        kept = frozenset(v for factor in (*tables, reward) for v in factor.scope if v not in seen)
        if kept not in joints:
            gone = [variable for variable in unnormalised.scope if variable not in kept]
            mass = unnormalised.marginalise(*gone) if gone else unnormalised
            axes = [*mass.scope, *seen]
            joints[kept] = axes, reduce(np.multiply, [table.array_over(axes) for table in (mass, *tables)])
        axes, joint = joints[kept]
        states = tuple(range(len(axes) - len(seen)))
        probability = joint.sum(axis=states)
        posterior = np.divide(joint, probability, out=np.zeros_like(joint), where=probability > 0)
        expected = (posterior * reward.array_over(axes)).sum(axis=states)
        total += float((expected * probability).sum())
    return total
