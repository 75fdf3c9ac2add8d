"""Sums of rewards in one table, or in a base and differences."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.factors.base import union
from factored_pomdp.files import sums
from factored_pomdp.files.sums import summed, with_base
from factored_pomdp.variables import Variable

VARIABLES = [Variable("act", "ab"), Variable("place", "xyz"), Variable("place", "xyz").next, Variable("seen", "no")]


TERM = st.tuples(
    st.lists(st.integers(0, 3), unique=True),
    st.lists(st.sampled_from([0.0, 0.0, 1.0, -2.5]), min_size=1, max_size=36),
    st.booleans(),
)
"""Which variables a term reads, its numbers (repeated as often as needed), and whether its table is sparse."""


def term(axes: list[int], numbers: list[float], sparse: bool) -> Factor:
    scope = [VARIABLES[axis] for axis in axes]
    table = DenseFactor(scope, np.resize(numbers, [variable.size for variable in scope]))
    return table.sparse() if sparse else table


def laid_out(factors: tuple[Factor, ...] | list[Factor]) -> np.ndarray:
    array = np.zeros([variable.size for variable in VARIABLES])
    for factor in factors:
        array += factor.array_over(VARIABLES)
    return array


@pytest.mark.property
@given(st.lists(TERM, min_size=1, max_size=4), st.sampled_from([0, 10, 36]))
def test_the_sum_is_the_same_in_one_table_or_two(drawn: list[tuple], most: int) -> None:
    factors = [term(*one) for one in drawn]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sums, "_MOST_PLACES", most)
        made = summed(factors)
    assert made is not None
    np.testing.assert_allclose(laid_out(made), laid_out(factors), rtol=0, atol=1e-12)
    if len(made) == 2:
        base, differences = made
        assert set(base.scope) < set(differences.scope)
        total, listed = laid_out(factors), with_base(base, differences.sparse())
        assert len(listed.numbers) == len(differences.sparse().numbers)
        for place, number in zip(listed.coordinates, listed.numbers, strict=True):
            at = [slice(None)] * 4
            for variable, position in zip(listed.scope, place, strict=True):
                at[VARIABLES.index(variable)] = int(position)
            np.testing.assert_allclose(total[tuple(at)], number, rtol=0, atol=1e-12)


@pytest.mark.example
def test_a_constant_and_a_table_without_end() -> None:
    place = Variable("place", [str(number) for number in range(100_000)])
    act = Variable("act", "ab")
    bumps = SparseFactor([place, place.next], [[3, 4], [5, 5]], [-4.0, 1.0])
    base, bonus = DenseFactor([act], [1.0, -1.0]), SparseFactor([place, place.next], [[5, 5], [9, 9]], [6.0, 2.0])
    made = summed([base, bumps, bonus])
    assert made is not None
    assert made[0].array_over([act]).tolist() == [1, -1]
    listed = with_base(made[0], made[1].sparse())
    assert listed.names == ("act", "place", "place.next")
    assert listed.coordinates.tolist() == [[a, *at] for a in (0, 1) for at in ([3, 4], [5, 5], [9, 9])]
    assert listed.numbers.tolist() == [-3, 8, 3, -5, 6, 1]


@pytest.mark.example
def test_what_is_too_large_in_two_tables_as_well_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sums, "_MOST_PLACES", 0)
    factors = [DenseFactor([variable], np.ones(variable.size)) for variable in VARIABLES[1:3]]
    assert union(*(factor.scope for factor in factors)) == tuple(VARIABLES[1:3])
    monkeypatch.setattr(sums, "MOST_ENTRIES", 9)
    assert summed(factors) is not None
    monkeypatch.setattr(sums, "MOST_ENTRIES", 8)
    assert summed(factors) is None
