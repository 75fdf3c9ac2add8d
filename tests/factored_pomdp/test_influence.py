"""Which variables make a difference: the witness differs in that variable alone, and nothing is passed over."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

from factored_pomdp.factors import Cause, DenseFactor, NoisyOr, SparseFactor
from factored_pomdp.influence import Influences, influence
from factored_pomdp.variables import Variable
from tests.factor_strategies import KINDS, PlainTable, factors

A, B = Variable("a", [0, 1]), Variable("b", [0, 1])


def differs(table: PlainTable, name: str) -> bool:
    groups: dict[tuple, set[float]] = {}
    place = table.names.index(name)
    for key, number in table.numbers.items():
        groups.setdefault(key[:place] + key[place + 1 :], set()).add(number)
    return any(max(numbers) - min(numbers) > 1e-9 for numbers in groups.values())


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=40)
@given(data=st.data())
def test_a_variable_is_found_to_matter_iff_it_does(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    for variable in factor.scope:
        witness = influence(factor, variable)
        if kind != "noisy-or":  # there, something may be said to matter that a certain cause hides
            assert (witness is not None) == differs(table, variable.name)
        assert witness is not None or not differs(table, variable.name)
        if witness is not None and kind != "noisy-or" and set(witness.others) == set(factor.names) - {variable.name}:
            numbers = [factor.value({**witness.others, variable.name: value}) for value in witness.values]
            assert numbers[0] != numbers[1]


@pytest.mark.example
def test_a_sparse_table_that_is_the_same_everywhere() -> None:
    full = SparseFactor([A, B], [[0, 0], [0, 1], [1, 0], [1, 1]], [-2.0, -2.0, -2.0, -2.0])
    assert influence(full, A) is None
    holes = SparseFactor([A, B], [[0, 0], [1, 0]], [-2.0, -2.0])
    assert influence(holes, A) is None
    assert influence(holes, B).values == (1, 0)


SEEN = Variable("seen", ["nothing", "x", "y"])
SHOWS_X = sparse.csr_array(np.array([[0, 1.0, 0]]))
SHOWS_Y = sparse.csr_array(np.array([[0, 0, 1.0]]))


@pytest.mark.example
@pytest.mark.parametrize(("after", "matters"), [(SHOWS_Y, True), (SHOWS_X, False)])
def test_a_cause_before_a_certain_one_matters_where_it_shows_something_else(after: object, matters: bool) -> None:
    either = np.array([[0.0], [1.0]])
    noisy = NoisyOr([], SEEN, "nothing", [Cause(A, either, SHOWS_X), Cause(None, np.ones((1, 1)), after)])
    assert (influence(noisy, A) is not None) == matters
    hidden = NoisyOr([], SEEN, "nothing", [Cause(None, np.ones((1, 1)), after), Cause(A, either, SHOWS_X)])
    assert influence(hidden, A) is None


@pytest.mark.example
def test_a_shared_table_is_looked_at_once_but_witnesses_have_the_own_names() -> None:
    found = Influences()
    one = DenseFactor([A, B], [[0, 1], [1, 0]])
    assert set(found.of(one, A).others) == {"b"}
    other = one.renamed({"a": "p", "b": "q"})
    assert set(found.of(other, other.scope[0]).others) == {"q"}
    assert found.scope(DenseFactor([A, B], [[1, 1], [0, 0]])) == (A,)
