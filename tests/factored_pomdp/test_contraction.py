"""Sums of products of factors against plain loops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.contraction import contract, contract_ancestors
from factored_pomdp.factors import DenseFactor
from factored_pomdp.variables import Variable
from tests.factor_strategies import POOL, assignments, factors


@pytest.mark.property
@settings(max_examples=60)
@given(st.data())
def test_contraction_is_the_sum_of_products(data: st.DataObject) -> None:
    drawn = data.draw(st.lists(factors(), min_size=0, max_size=4))
    scope = tuple(dict.fromkeys(variable for factor, _ in drawn for variable in factor.scope))
    keep = data.draw(st.lists(st.sampled_from([*scope, *POOL]), unique=True))
    result = contract([factor for factor, _ in drawn], keep)
    assert set(result.scope) == set(keep) & set(scope)
    inner = tuple(variable for variable in scope if variable not in keep)
    for at in assignments(result.scope):
        total = sum(
            math.prod(table.numbers[tuple({**at, **rest}[name] for name in table.names)] for _, table in drawn)
            for rest in assignments(inner)
        )
        assert result.value(at) == pytest.approx(total, abs=1e-9)


@pytest.mark.example
def test_nothing_to_contract_is_one() -> None:
    assert contract([], []).value({}) == 1.0


@pytest.mark.example
def test_only_ancestors_are_touched() -> None:
    x, y, z = (Variable(name, [0, 1]) for name in "xyz")
    laws = {
        "x": DenseFactor([x], [0.25, 0.75]),
        "y": DenseFactor([x, y], [[1, 0], [0.5, 0.5]]),
        "z": DenseFactor([z], [float("nan"), 0]),  # would spoil every sum that it took part in
    }
    np.testing.assert_allclose(contract_ancestors(laws, [y]).array_over([y]), [0.625, 0.375])
