"""A tie's counterexample worked out again by loops over the joint model, from what the counterexample itself says."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

import factored_pomdp as fp
from factored_pomdp.decomposition import Tie
from factored_pomdp.structure import GOES_ON
from tests.plain import PlainModel

__all__ = ["confirm"]

Assignment = dict[str, Any]


def confirm(model: fp.FactoredPOMDP, tie: Tie) -> None:
    """Fail unless every number of the counterexample is right, and shows a tie of its kind."""
    shown = dict(tie.counterexample or {})
    _KINDS[shown["kind"]](model, tie, shown)


def _belief(model: fp.FactoredPOMDP, tie: Tie, shown: Assignment) -> None:
    assert tie.kind in ("initial", "terminal")
    plain = PlainModel(model)
    over = model.is_terminal if tie.kind == "terminal" else lambda state: False
    masses = {tuple(state.values()): 0.0 if over(state) else plain.initial(state) for state in plain.states}
    total = math.fsum(masses.values())
    masses = {state: mass / total for state, mass in masses.items()}

    def mass(at: Mapping[str, Any]) -> float:
        return math.fsum(masses[tuple(s.values())] for s in plain.states if at.items() <= s.items())

    at = shown["at"]
    product = math.prod(mass({name: at[name] for name in thing if name in at}) for thing in tie.joins)
    assert shown["joint"] == pytest.approx(mass(at), abs=1e-9)
    assert shown["product"] == pytest.approx(product, abs=1e-9)
    assert abs(shown["joint"] - shown["product"]) > 1e-6


def _posterior(model: fp.FactoredPOMDP, tie: Tie, shown: Assignment) -> None:
    assert tie.kind in ("transition", "observation", "terminal")
    after = _after(model, shown, shown["belief"])
    at = shown["at"]
    product = math.prod(_mass(after, {name: at[name] for name in thing}) for thing in tie.joins)
    assert shown["joint"] == pytest.approx(_mass(after, at), abs=1e-9)
    assert shown["product"] == pytest.approx(product, abs=1e-9)
    assert abs(shown["joint"] - shown["product"]) > 1e-6


def _two_beliefs(model: fp.FactoredPOMDP, tie: Tie, shown: Assignment) -> None:
    assert tie.kind in ("transition", "observation", "terminal")
    changed = set(shown["other_belief"])
    assert any(changed == set(thing) for thing in tie.joins)
    assert not changed & set(shown["at"])
    one = _mass(_after(model, shown, shown["belief"]), shown["at"])
    other = _mass(_after(model, shown, {**shown["belief"], **shown["other_belief"]}), shown["at"])
    assert shown["posterior"] == pytest.approx(one, abs=1e-9)
    assert shown["other_posterior"] == pytest.approx(other, abs=1e-9)
    assert abs(one - other) > 1e-6


def _value(model: fp.FactoredPOMDP, tie: Tie, shown: Assignment) -> None:
    assert tie.kind == "reward"
    first, _ = _two_things(tie, set(shown["ends"]))
    reward = model.reward[tie.factor.removeprefix("reward ")]
    numbers = {}
    for one, two in itertools.product((0, 1), repeat=2):
        ends = {name: (one if name in first else two, values) for name, values in shown["ends"].items()}
        point = {name: {values[min(end, len(values) - 1)]: 1.0} for name, (end, values) in ends.items()}
        numbers[one, two] = _expected(model, shown, {**shown["belief"], **point}, reward)
    mixed = numbers[0, 0] + numbers[1, 1] - numbers[0, 1] - numbers[1, 0]
    assert shown["mixed_difference"] == pytest.approx(mixed, abs=1e-9)
    assert abs(mixed) > 1e-6
    said = shown["values"]
    assert said["00"] + said["11"] - said["01"] - said["10"] == pytest.approx(mixed, abs=1e-9)


def _two_things(tie: Tie, names: set[str]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    return next((a, b) for a, b in itertools.combinations(tie.joins, 2) if set(a) | set(b) == names)


def _starts(
    model: fp.FactoredPOMDP, shown: Assignment, belief: Mapping[str, Mapping]
) -> Iterator[tuple[Assignment, float]]:
    """Current joint states with their masses; hidden variables of other blocks stand at their first value."""
    masses = {v.name: {v.values[0]: 1.0} for v in model.states}
    masses |= {name: {value: 1.0} for name, value in shown["known"].items()} | dict(belief)
    for values in itertools.product(*(mass.items() for mass in masses.values())):
        yield {n: value for n, (value, _) in zip(masses, values, strict=True)}, math.prod(p for _, p in values)


def _after(model: fp.FactoredPOMDP, shown: Assignment, belief: Mapping[str, Mapping]) -> list[tuple[Assignment, float]]:
    """Posterior over next joint states, by Bayes' rule."""
    plain, action = PlainModel(model), shown["action"]
    told = dict(shown["observation"])
    goes_on = told.pop(GOES_ON.name, False)
    seen = {name: value for name, value in told.items() if name in model.observation}
    read = {name.removesuffix(".next"): v for name, v in told.items() if name not in seen}
    weighed = []
    for after in plain.states:
        if not read.items() <= after.items() or (goes_on and model.is_terminal(after)):
            continue
        given = {**action, **seen, **{f"{name}.next": value for name, value in after.items()}}
        likelihood = math.prod(plain.number(model.observation[name], given) for name in seen)
        if likelihood > 0:
            mass = math.fsum(p * plain.moves(now, action, after) for now, p in _starts(model, shown, belief))
            weighed.append((after, mass * likelihood))
    total = math.fsum(mass for _, mass in weighed)
    return [(after, mass / total) for after, mass in weighed]


def _mass(after: list[tuple[Assignment, float]], at: Assignment) -> float:
    return math.fsum(mass for state, mass in after if at.items() <= state.items())


def _expected(model: fp.FactoredPOMDP, shown: Assignment, belief: Mapping[str, Mapping], reward: fp.Factor) -> float:
    plain, action = PlainModel(model), shown["action"]
    total = 0.0
    for now, mass in _starts(model, shown, belief):
        for after in plain.states:
            moving = mass * plain.moves(now, action, after)
            if moving > 0:
                given = {**now, **action, **{f"{name}.next": value for name, value in after.items()}}
                for seen in plain.observations:
                    total += moving * plain.sees(after, action, seen) * plain.number(reward, {**given, **seen})
    return total


_KINDS = {"belief": _belief, "posterior": _posterior, "two beliefs": _two_beliefs, "value": _value}
