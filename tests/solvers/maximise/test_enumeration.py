"""Every joint action looked at, against plain loops."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor
from factored_pomdp.variables import Variable
from solvers.maximise.enumeration import enumerate_all
from tests.factor_strategies import POOL, assignments, factors


@pytest.mark.property
@settings(max_examples=40)
@given(st.lists(factors(("dense", "sparse", "deterministic", "expected noisy-or")), max_size=4), st.permutations(POOL))
def test_the_best_of_all_is_found(drawn: list, actions: list[Variable]) -> None:
    found = enumerate_all([factor for factor, _ in drawn], actions)
    sums = [
        sum(table.numbers[tuple(at[name] for name in table.names)] for _, table in drawn)
        for at in assignments(tuple(actions))
    ]
    assert found.value == pytest.approx(max(sums), abs=1e-9)
    assert found.upper_bound == found.value
    assert found.proved
    chosen = list(assignments(tuple(actions))).index(dict(found.action))
    assert sums[chosen] == pytest.approx(max(sums), abs=1e-9)
    assert found.method == f"enumeration of {len(sums)} joint actions"


@pytest.mark.example
def test_among_equals_the_preferred_values_then_the_first() -> None:
    actions = [Variable(name, [0, 1, 2]) for name in "pq"]
    level = DenseFactor(actions, np.zeros((3, 3)))
    assert enumerate_all([level], actions).action == {"p": 0, "q": 0}
    assert enumerate_all([level], actions, {"q": 2}).action == {"p": 0, "q": 2}
    assert enumerate_all([level], actions, {"p": 1, "q": 2}).action == {"p": 1, "q": 2}
    assert enumerate_all([level], actions, {"p": "gone"}).action == {"p": 0, "q": 0}
    better = DenseFactor(actions, [[0, 0, 1], [1, 0, 0], [0, 1, 0]])
    best = [values for values in itertools.product(range(3), repeat=2) if better.array[values] == 1]
    assert best == [(0, 2), (1, 0), (2, 1)]
    assert enumerate_all([better], actions, {"p": 1, "q": 1}).action == {"p": 1, "q": 0}
    assert enumerate_all([better], actions, {"q": 1}).action == {"p": 2, "q": 1}
