"""A model computed by plain loops over joint assignments, from its tables alone: slow, and easy to believe."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from functools import cached_property

import factored_pomdp as fp
from factored_pomdp.factors import Factor

__all__ = ["PlainModel"]

State = tuple
Assignment = Mapping[str, object]


class PlainModel:
    """Loops over all joint states, actions and observations."""

    def __init__(self, model: fp.FactoredPOMDP) -> None:
        self.model = model
        self.states = _assignments(model.states)
        self.actions = _assignments(model.actions)
        self.observations = _assignments(model.observations)
        self._tables = {
            id(f): _table(f)
            for part in (model.initial, model.transition, model.observation, model.reward)
            for f in part.values()
        }

    def number(self, factor: Factor, given: Assignment) -> float:
        return self._tables[id(factor)][tuple(given[name] for name in factor.names)]

    def initial(self, state: Assignment) -> float:
        return self._product(self.model.initial.values(), state)

    def moves(self, state: Assignment, action: Assignment, after: Assignment) -> float:
        given = {**state, **action, **{f"{name}.next": value for name, value in after.items()}}
        return self._product(self.model.transition.values(), given)

    def sees(self, after: Assignment, action: Assignment, seen: Assignment) -> float:
        given = {**action, **seen, **{f"{name}.next": value for name, value in after.items()}}
        return self._product(self.model.observation.values(), given)

    def reward(self, state: Assignment, action: Assignment, after: Assignment, seen: Assignment) -> float:
        given = {**state, **action, **seen, **{f"{name}.next": value for name, value in after.items()}}
        return sum(self.number(factor, given) for factor in self.model.reward.values())

    def expected_reward(self, state: Assignment, action: Assignment) -> float:
        """E[R | s, a]."""
        total = 0.0
        for after in self.states:
            moving = self.moves(state, action, after)
            if moving > 0:
                for seen in self.observations:
                    total += moving * self.sees(after, action, seen) * self.reward(state, action, after, seen)
        return total

    @cached_property
    def start(self) -> list[float]:
        return [self.initial(state) for state in self.states]

    def predict(self, belief: list[float], action: Assignment) -> list[float]:
        return [
            sum(
                mass * self.moves(state, action, after) for mass, state in zip(belief, self.states, strict=True) if mass
            )
            for after in self.states
        ]

    def condition(self, predicted: list[float], action: Assignment, seen: Assignment) -> tuple[list[float], float]:
        """Posterior and P(z | B, a)."""
        weights = [mass * self.sees(after, action, seen) for mass, after in zip(predicted, self.states, strict=True)]
        total = sum(weights)
        return [weight / total for weight in weights] if total > 0 else weights, total

    def value(self, belief: list[float], action: Assignment) -> float:
        """Expected reward of the next step."""
        return sum(
            mass * self.expected_reward(state, action) for mass, state in zip(belief, self.states, strict=True) if mass
        )

    def _product(self, factors: object, given: Assignment) -> float:
        product = 1.0
        for factor in factors:
            product *= self.number(factor, given)
            if product == 0.0:
                return 0.0
        return product


def _assignments(variables: tuple[fp.Variable, ...]) -> list[dict[str, object]]:
    names = [variable.name for variable in variables]
    return [dict(zip(names, values, strict=True)) for values in itertools.product(*(v.values for v in variables))]


def _table(factor: Factor) -> dict[tuple, float]:
    keys = itertools.product(*(variable.values for variable in factor.scope))
    return dict(zip(keys, factor.dense().array.ravel().tolist(), strict=True))
