"""Greedy choice with swaps: its bound holds, and it says what was not proved."""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor, ExpectedNoisyOr, Factor
from factored_pomdp.factors.expected_noisy_or import WeightedCause
from factored_pomdp.variables import Variable
from solvers.base import Decision
from solvers.maximise.greedy import greedy_with_swaps
from tests.strategies import random_module_as_found


def coverage(rng: np.random.Generator, actions: list[Variable], cells: int, *, chance: bool) -> ExpectedNoisyOr:
    """Cells of random weight, each action value covering some of them, surely or by chance."""
    weights = rng.random(cells) * (rng.random(cells) < 0.7)
    causes = []
    for variable in actions:
        covers = rng.random((variable.size, cells)) < 0.4
        strength = rng.random((variable.size, cells)) if chance else 1.0
        causes.append(WeightedCause(variable, covers * strength, np.ones(cells)))
    return ExpectedNoisyOr(weights, causes, np.zeros(cells))


def covered(cover: ExpectedNoisyOr, choice: tuple[int, ...]) -> float:
    """Σ_l w(l) [1 − ∏ (1 − p)] by loops."""
    total = 0.0
    for cell, weight in enumerate(cover.weights):
        missed = 1.0
        for cause, value in zip(cover.causes, choice, strict=True):
            missed *= 1 - cause.activation[value, cell]
        total += weight * (1 - missed)
    return total


def check(found: Decision, best: float, value: float) -> None:
    assert found.value == pytest.approx(value, abs=1e-9)
    assert found.value <= best + 1e-9
    assert best <= found.upper_bound + 1e-9
    if found.proved:
        assert found.value == pytest.approx(best, abs=1e-8)
        assert "not proved" not in found.method
    else:
        gap = re.search(r"\(not proved: within (\S+) of the best\)", found.method)
        assert float(gap[1]) == pytest.approx(found.gap, rel=1e-5)


@pytest.mark.property
@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 4), st.booleans())
def test_the_bound_holds_on_coverage_and_the_choice_is_at_least_half_as_good(
    seed: int, number: int, chance: bool
) -> None:
    rng = np.random.default_rng(seed)
    actions = [Variable(f"c{k}", range(3)) for k in range(number)]
    with random_module_as_found():
        cover = coverage(rng, actions, 8, chance=chance)
        found = greedy_with_swaps([cover], actions)
    values = {choice: covered(cover, choice) for choice in itertools.product(range(3), repeat=number)}
    best = max(values.values())
    check(found, best, values[tuple(found.action.values())])
    assert found.value >= best / 2 - 1e-9


@pytest.mark.property
@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_the_bound_holds_on_any_mixture(seed: int) -> None:
    """Covers, costs of single values, terms on pairs, payoffs that differ or are below silence, negative weights."""
    rng = np.random.default_rng(seed)
    actions = [Variable(f"c{k}", range(3)) for k in range(3)]
    with random_module_as_found():
        functions: list[Factor] = [coverage(rng, actions, 6, chance=True)]
        causes = [WeightedCause(a, rng.random((3, 4)), rng.normal(size=4)) for a in actions]
        leak = WeightedCause(None, rng.random((1, 4)) / 4, rng.normal(size=4))
        functions.append(ExpectedNoisyOr(rng.normal(size=4), [*causes, leak], rng.normal(size=4)))
        functions += [DenseFactor([a], rng.normal(size=3)) for a in actions[:2]]
        functions.append(DenseFactor([actions[2], actions[0]], rng.normal(size=(3, 3))))
        found = greedy_with_swaps(functions, actions)
        total = sum(function.array_over(actions) for function in functions)
    check(found, float(total.max()), float(total[tuple(found.action.values())]))


@pytest.mark.example
def test_where_greedy_alone_errs_a_swap_mends_it() -> None:
    """The first camera's best preset covers 3, but together with the second one 2 + 3 are to be had."""
    one, two = Variable("one", ["a", "b"]), Variable("two", ["a", "b"])
    weights = np.array([3.0, 2.0])
    causes = [
        WeightedCause(one, np.array([[1.0, 0.0], [0.0, 1.0]]), np.ones(2)),
        WeightedCause(two, np.array([[1.0, 0.0], [0.0, 0.0]]), np.ones(2)),
    ]
    found = greedy_with_swaps([ExpectedNoisyOr(weights, causes, np.zeros(2))], [one, two])
    assert found.action == {"one": "b", "two": "a"}
    assert (found.value, found.upper_bound) == (5.0, 5.0)
    assert found.proved


@pytest.mark.example
def test_nothing_to_gain_is_proved_and_keeps_what_is_preferred() -> None:
    actions = [Variable(f"c{k}", range(3)) for k in range(4)]
    cover = ExpectedNoisyOr(np.zeros(2), [WeightedCause(a, np.ones((3, 2)), np.ones(2)) for a in actions], np.zeros(2))
    assert greedy_with_swaps([cover], actions).action == dict.fromkeys(["c0", "c1", "c2", "c3"], 0)
    assert greedy_with_swaps([cover], actions, {"c2": 1}).action == {"c0": 0, "c1": 0, "c2": 1, "c3": 0}
    assert greedy_with_swaps([cover], actions).proved
    assert greedy_with_swaps([], actions).value == 0.0
