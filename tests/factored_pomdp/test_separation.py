"""Tables that fall apart into a sum or a product, and the finest way in which they do."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor
from factored_pomdp.separation import additive_parts, multiplicative_parts
from factored_pomdp.variables import Variable

CONTEXT = Variable("context", [0, 1])
VARIABLES = [Variable(name, range(size)) for name, size in (("p", 2), ("q", 3), ("r", 2), ("s", 2))]
PARTITIONS = [[[0, 1, 2, 3]], [[0], [1], [2], [3]], [[0, 2], [1], [3]], [[0], [1, 2, 3]], [[0, 3], [1, 2]]]


def random_parts(partition: list[list[int]], seed: int) -> list[DenseFactor]:
    rng = np.random.default_rng(seed)
    scopes = [[CONTEXT, *(VARIABLES[number] for number in component)] for component in partition]
    return [DenseFactor(scope, rng.random([variable.size for variable in scope]) + 0.1) for scope in scopes]


@pytest.mark.property
@settings(max_examples=40)
@given(st.sampled_from(PARTITIONS), st.integers(0, 2**32 - 1), st.permutations(range(4)))
def test_a_product_is_taken_apart_and_its_parts_multiply_to_it(partition: list, seed: int, order: list[int]) -> None:
    parts = random_parts(partition, seed)
    whole = functools.reduce(lambda a, b: a.product(b), parts)
    groups = [(VARIABLES[number],) for number in order]
    found = multiplicative_parts(whole, groups)
    assert {frozenset(order[n] for n in component) for component, _ in found} == {frozenset(c) for c in partition}
    again = functools.reduce(lambda a, b: a.product(b), (part for _, part in found))
    scope = [CONTEXT, *VARIABLES]
    np.testing.assert_allclose(again.array_over(scope), whole.array_over(scope), rtol=1e-9)


@pytest.mark.property
@settings(max_examples=40)
@given(st.sampled_from(PARTITIONS), st.integers(0, 2**32 - 1), st.permutations(range(4)))
def test_a_sum_is_taken_apart_and_its_parts_add_up_to_it(partition: list, seed: int, order: list[int]) -> None:
    parts = random_parts(partition, seed)
    scope = [CONTEXT, *VARIABLES]
    whole = DenseFactor(scope, functools.reduce(lambda a, b: a + b, (part.array_over(scope) for part in parts)))
    found = additive_parts(whole, [(VARIABLES[number],) for number in order])
    assert {frozenset(order[n] for n in component) for component, _ in found} == {frozenset(c) for c in partition}
    again = functools.reduce(lambda a, b: a + b, (part.array_over(scope) for _, part in found))
    np.testing.assert_allclose(again, whole.array, atol=1e-12)


@pytest.mark.example
def test_groups_of_several_variables_are_not_taken_apart() -> None:
    p, q, r, _ = VARIABLES
    whole = DenseFactor([p, q, r], np.add.outer(np.add.outer([1.0, 2.0], [3.0, 5.0, 8.0]), [0.0, 4.0]))
    assert [component for component, _ in additive_parts(whole, [(p, r), (q,)])] == [[0], [1]]
    assert [part.scope for _, part in additive_parts(whole, [(p, r), (q,)])] == [(p, r), (q,)]


@pytest.mark.example
def test_a_rare_slice_is_judged_by_its_own_scale() -> None:
    p, _, r, _ = VARIABLES
    rare = 1e-9 * np.array([[1.0, 0.0], [0.0, 1.0]])
    seen = DenseFactor([CONTEXT, p, r], np.stack([np.full((2, 2), 0.5), rare]))
    assert len(multiplicative_parts(seen, [(p,), (r,)])) == 1


@pytest.mark.example
def test_a_slice_of_zeros_is_no_tie() -> None:
    p, _, r, _ = VARIABLES
    seen = DenseFactor([CONTEXT, p, r], np.stack([np.outer([0.5, 0.5], [1.0, 2.0]), np.zeros((2, 2))]))
    parts = multiplicative_parts(seen, [(p,), (r,)])
    assert len(parts) == 2
    np.testing.assert_allclose(parts[0][1].product(parts[1][1]).array_over([CONTEXT, p, r]), seen.array)


@pytest.mark.example
def test_eight_groups_two_of_them_tied() -> None:
    rng = np.random.default_rng(4)
    variables = [Variable(f"x{number}", range(2)) for number in range(8)]
    tied = DenseFactor(variables[2:4], [[0.9, 0.1], [0.2, 0.8]])
    alone = [DenseFactor([variable], rng.random(2)) for variable in (*variables[:2], *variables[4:])]
    whole = functools.reduce(lambda a, b: a.product(b), [tied, *alone])
    found = multiplicative_parts(whole, [(variable,) for variable in variables])
    assert sorted(component for component, _ in found) == [[0], [1], [2, 3], [4], [5], [6], [7]]
    again = functools.reduce(lambda a, b: a.product(b), (part for _, part in found))
    np.testing.assert_allclose(again.array_over(variables), whole.array_over(variables), rtol=1e-9)
