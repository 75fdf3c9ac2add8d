"""A belief over joint states: exact for every model, exponential in the number of variables (eq:belup, literally).

The table is dense, or sparse where few joint states have mass; both forms do the same products and sums. As in a
product belief, mass in terminal states is left out: whoever acts is told that the episode goes on.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from factored_pomdp.errors import ImpossibleObservation, TooLarge
from factored_pomdp.expansion import branching
from factored_pomdp.factors import DenseFactor, Factor
from factored_pomdp.factors.base import MAX_ENTRIES
from factored_pomdp.factors.dense import constant
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import GOES_ON
from factored_pomdp.variables import Value, Variable

__all__ = ["JointBelief"]

_EXACT: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class JointBelief:
    """Probabilities of joint states.

    Attributes
    ----------
    table : Factor
        Over all state variables; sums to one.
    """

    model: FactoredPOMDP
    table: Factor
    sparse: bool = False
    action: Mapping[str, Value] | None = None

    exact = True

    @classmethod
    def initial(cls, model: FactoredPOMDP, sparse: bool = False) -> JointBelief:
        """The model's initial belief, multiplied out, given that the episode does not end at once.

        Raises
        ------
        TooLarge
            With the number of joint states that may be possible, before anything is allocated.
        """
        possible = math.prod(branching(factor, name) for name, factor in model.initial.items())
        if (possible if sparse else model.joint_states) > MAX_ENTRIES:
            raise TooLarge(
                f"the joint belief of {model.name}: up to {possible:,} of {model.joint_states:,} joint states at the "
                f"start, more than {MAX_ENTRIES:,}"
            )
        table = _multiplied(constant(1.0), model.initial.values(), sparse)
        return cls(model, table, sparse).running()

    def predict(self, action: Any) -> JointBelief:
        """``Σ_S P(S' | S, A) B(S)`` over all joint states."""
        chosen = self.model.action(action)
        table, left = self.running()._moved_by_itself
        table, _ = self._moved(table, {name: factor.condition(chosen) for name, factor in left.items()}, {})
        named = table.renamed({variable.next.name: variable.name for variable in self.model.states})
        return replace(self, table=named, action=chosen)

    def running(self) -> JointBelief:
        """The belief given that the episode goes on; this very one where it holds no mass in terminal states."""
        if self.model.running is None:
            return self
        table = self.table.product(_laid_out(self.model.running, self.sparse))
        total = _total(table)
        if not total > 0:
            names = [variable.name for variable in self.model.states]
            raise ImpossibleObservation(names, dict(self.action or {}), {GOES_ON.name: True})
        return self if total >= _total(self.table) else replace(self, table=table.product(constant(1 / total)))

    @cached_property
    def _moved_by_itself(self) -> tuple[Factor, dict[str, Factor]]:
        """The table after those transitions that no action touches, which are the same for every action; the others."""
        actions = set(self.model.actions)
        free = {name: factor for name, factor in self.model.transition.items() if not actions & set(factor.scope)}
        return self._moved(self.table, free, {n: f for n, f in self.model.transition.items() if n not in free})

    def _moved(
        self, table: Factor, ready: Mapping[str, Factor], later: Mapping[str, Factor]
    ) -> tuple[Factor, dict[str, Factor]]:
        """Multiply transitions in, those whose parents are there; sum out what nothing reads any more."""
        left = dict(ready)
        while True:
            waiting = {f"{name}.next" for name in (*left, *later)}
            names = [n for n, f in left.items() if not waiting & set(f.names) - {f"{n}.next"}]
            if not names:
                return table, {**left, **later}
            table = table.product(_laid_out(left.pop(names[0]), self.sparse))
            needed = {name for factor in (*left.values(), *later.values()) for name in factor.names}
            done = [v for v in table.scope if not v.is_next and v.name not in needed]
            table = table.marginalise(*done) if done else table

    def likelihood(self, observation: Mapping[str, Value], known: Mapping[str, Value] | None = None) -> Factor:
        """``P(Z | S')`` as a table over next states (named as current ones), the unread ``known`` saying nothing."""
        unread = {f"{name}.next": None for name, value in (known or {}).items() if value is None}
        factors = []
        for name, value in observation.items():
            given = {**(self.action or {}), **unread, name: value}
            factors.append(self.model.observation[name].condition(given))
        names = {variable.next.name: variable.name for variable in self.model.states}
        return _multiplied(constant(1.0), (factor.renamed(names) for factor in factors), self.sparse)

    def condition(self, observation: Any = None, known: Mapping[str, Value] | None = None) -> JointBelief:
        """The posterior; as `ProductBelief.condition`."""
        observed = self.model.observed(observation) if observation is not None else {}
        table = self.table
        for name, value in (known or {}).items():
            if value is not None:
                table = self._read(table, self.model.variable(name), value)
        table = table.product(self.likelihood(observed, known))
        total = _total(table)
        if not total > 0:
            raise ImpossibleObservation([v.name for v in self.model.states], dict(self.action or {}), observed)
        return replace(self, table=table.product(constant(1 / total))).running()

    def _read(self, table: Factor, variable: Variable, value: Value) -> Factor:
        """The table where a variable was read back; a value other than the only one that was planned replaces it."""
        certain = DenseFactor([variable], [float(v == value) for v in variable.values])
        evidence = table.product(certain)
        if _total(evidence) > 0:
            return evidence
        if (self.marginal(variable.name).array > 0).sum() > 1:
            raise ImpossibleObservation([variable.name], dict(self.action or {}), {variable.name: value})
        return table.marginalise(variable).product(certain)

    def probability(self, observation: Any) -> float:
        """``P(Z | B, A)`` of a predicted belief."""
        return _total(self.table.product(self.likelihood(self.model.observed(observation))))

    def marginal(self, *names: str) -> DenseFactor:
        """Joint probabilities of some state variables."""
        kept = [self.model.variable(name) for name in names]
        rest = [variable for variable in self.table.scope if variable not in kept]
        table = self.table.marginalise(*rest) if rest else self.table
        return DenseFactor(kept, table.array_over(kept))


def _laid_out(factor: Factor, sparse: bool) -> Factor:
    return factor.sparse() if sparse else factor.dense()


def _multiplied(start: Factor, factors: Iterable[Factor], sparse: bool) -> Factor:
    product = _laid_out(start, sparse)
    for factor in factors:
        product = product.product(_laid_out(factor, sparse))
    return product


def _total(table: Factor) -> float:
    return float(table.marginalise(*table.scope).dense().array)
