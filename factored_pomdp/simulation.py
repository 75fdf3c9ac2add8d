"""Draw a world from a model: states, observations and rewards, straight from its factors.

Every distribution is drawn at the values that are known by then, one variable after the other, so a noisy-or is never
expanded and a sparse factor is only looked up; the code shares nothing with the beliefs that are checked against it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value, Variable

__all__ = ["Simulation"]

Assignment = dict[str, Value]


class Simulation:
    """A model as a world.

    Parameters
    ----------
    model : FactoredPOMDP

    Notes
    -----
    Memory: one more copy of every distinct sparse table, sorted by its parents. Time of a step: one draw a variable.
    """

    def __init__(self, model: FactoredPOMDP) -> None:
        self.model = model
        tables: dict[Any, _Lines] = {}
        after = {name: f"{name}.next" for name in model.transition}
        self._initial = _in_order({name: name for name in model.initial}, model.initial, tables)
        self._transition = _in_order(after, model.transition, tables)
        self._observation = _in_order({name: name for name in model.observation}, model.observation, tables)

    def start(self, rng: np.random.Generator) -> Assignment:
        """A state drawn from the initial belief."""
        drawn: Assignment = {}
        for sampler in self._initial:
            drawn[sampler.child.name] = sampler.draw(drawn, rng)
        return {variable.name: drawn[variable.name] for variable in self.model.states}

    def step(
        self, state: Mapping[str, Value], action: Any, rng: np.random.Generator
    ) -> tuple[Assignment, Assignment, float]:
        """One step of the world.

        Returns
        -------
        next state, observation : dict
        reward : float
            Of this very transition and observation, not its expectation.

        Raises
        ------
        ValueError
            For an action that is not legal in the state.

        Notes
        -----
        Where ``model.is_terminal(next state)``, the episode is over. A step from a terminal state stays there and earns
        nothing, as in the joint expansion.
        """
        given: Assignment = {**state, **self.model.action(action)}
        if self.model.is_terminal(state):
            return self._stay(given, rng)
        self._refuse_illegal(given)
        for sampler in (*self._transition, *self._observation):
            given[sampler.child.name] = sampler.draw(given, rng)
        reward = sum(factor.value(given) for factor in self.model.reward.values())
        after = {variable.name: given[variable.next.name] for variable in self.model.states}
        return after, {variable.name: given[variable.name] for variable in self.model.observations}, reward

    def _refuse_illegal(self, given: Mapping[str, Value]) -> None:
        for name, rule in self.model.legal.items():
            if not rule.value(given):
                at = ", ".join(f"{other}={given[other]!r}" for other in rule.names if other != name)
                legal = [value for value in rule.variable(name).values if rule.value({**given, name: value})]
                raise ValueError(f"{name}={given[name]!r} is not legal at {at}; legal: {', '.join(map(repr, legal))}")

    def _stay(self, given: Assignment, rng: np.random.Generator) -> tuple[Assignment, Assignment, float]:
        state = {variable.name: given[variable.name] for variable in self.model.states}
        given |= {variable.next.name: given[variable.name] for variable in self.model.states}
        for sampler in self._observation:
            given[sampler.child.name] = sampler.draw(given, rng)
        return state, {variable.name: given[variable.name] for variable in self.model.observations}, 0.0


class _Sampler:
    """Draws one variable given the values of its parents."""

    def __init__(self, factor: Factor, child: Variable, tables: dict[Any, _Lines]) -> None:
        self.factor, self.child = factor, child
        self._lines: _Lines | None = None
        if isinstance(factor, SparseFactor):
            key = (*factor.storage, factor.scope.index(child), *(variable.size for variable in factor.scope))
            if key not in tables:
                tables[key] = _Lines(factor, child)
            self._lines = tables[key]

    def draw(self, given: Mapping[str, Value], rng: np.random.Generator) -> Value:
        """A value of the child."""
        parents = [variable for variable in self.factor.scope if variable != self.child]
        at = {variable.name: given[variable.name] for variable in parents}
        if isinstance(self.factor, DeterministicFactor) and self.factor.child == self.child:
            return self.factor.result(at)
        if isinstance(self.factor, NoisyOr):
            return _first_to_act(self.factor, at, rng)
        if self._lines is not None:
            indexes, weights = self._lines.at([variable.index(at[variable.name]) for variable in parents])
        else:
            weights = self.factor.condition(at).array_over([self.child])
            indexes = np.arange(self.child.size)
        return self.child.values[int(indexes[_position(weights, rng)])]


class _Lines:
    """A sparse table sorted by the child's parents, so that one distribution is found without a search through all."""

    def __init__(self, factor: SparseFactor, child: Variable) -> None:
        self.parents = tuple(variable for variable in factor.scope if variable != child)
        keys = factor.flat(self.parents)
        order = np.argsort(keys, kind="stable")
        self.keys, self.weights = keys[order], factor.numbers[order]
        self.indexes = factor.coordinates[order, factor.scope.index(child)]

    def at(self, values: Iterable[int]) -> tuple[np.ndarray, np.ndarray]:
        """Positions of the child's values, and their probabilities, at positions of the parents' values."""
        key = 0
        for parent, value in zip(self.parents, values, strict=True):
            key = key * parent.size + value
        line = slice(np.searchsorted(self.keys, key, "left"), np.searchsorted(self.keys, key, "right"))
        return self.indexes[line], self.weights[line]


def _in_order(children: Mapping[str, str], factors: Mapping[str, Factor], tables: dict[Any, _Lines]) -> list[_Sampler]:
    """Samplers in an order in which every parent of the same slice comes first."""
    left = {children[name]: factor for name, factor in factors.items()}
    ordered = []
    while left:
        name = next(n for n, f in left.items() if not any(v.name in left for v in f.scope if v.name != n))
        factor = left.pop(name)
        ordered.append(_Sampler(factor, factor.variable(name), tables))
    return ordered


def _first_to_act(factor: NoisyOr, given: Mapping[str, Value], rng: np.random.Generator) -> Value:
    """Causes act one after the other; the first that does draws what is seen (that is what a noisy-or says)."""
    context = 0
    for variable in factor.context:
        context = context * variable.size + variable.index(given[variable.name])
    for cause in factor.causes:
        row = cause.variable.index(given[cause.variable.name]) if cause.variable is not None else 0
        if rng.random() < cause.activation[row, context]:
            shown = DenseFactor([factor.child], cause.emission[[context], :].toarray().ravel())
            return factor.child.values[_position(shown.array, rng)]
    return factor.off


def _position(weights: np.ndarray, rng: np.random.Generator) -> int:
    totals = np.cumsum(weights)
    return int(np.searchsorted(totals, rng.random() * totals[-1], side="right"))
