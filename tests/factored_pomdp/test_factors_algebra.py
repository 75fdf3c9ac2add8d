"""One algebra for every representation: each operation against plain loops over the table."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.variables import Variable
from tests.factor_strategies import KINDS, POOL, PlainTable, as_plain, assignments, factors

Drawn = tuple[Factor, PlainTable]


def expect(factor: Factor, names: set[str], number: object) -> None:
    """The factor is over these names, and has the number that a function of the assignment gives."""
    assert set(factor.names) == names
    assert len(factor.scope) == len(names)
    for given_values in assignments(factor.scope):
        assert factor.value(given_values) == pytest.approx(number(given_values), abs=1e-12)


def look(table: PlainTable, at: dict[str, object]) -> float:
    return table.numbers[tuple(at[name] for name in table.names)]


def values_of(factor: Factor) -> dict[str, tuple]:
    return {variable.name: variable.values for variable in factor.scope}


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25)
@given(data=st.data())
def test_dense_and_sparse_form_say_the_same(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    for form in (factor, factor.dense(), factor.sparse()):
        assert set(form.names) == set(table.names)
        said = as_plain(form)
        for key, number in said.numbers.items():
            assert number == pytest.approx(look(table, dict(zip(said.names, key, strict=True))), abs=1e-12)


@pytest.mark.property
@pytest.mark.parametrize(("one", "other"), list(itertools.product(KINDS, KINDS)))
@settings(max_examples=6)
@given(data=st.data())
def test_product(one: str, other: str, data: st.DataObject) -> None:
    (left, left_table), (right, right_table) = data.draw(factors((one,))), data.draw(factors((other,)))
    both = set(left.names) | set(right.names)
    expect(left.product(right), both, lambda at: look(left_table, at) * look(right_table, at))


@pytest.mark.property
@pytest.mark.parametrize("operation", ["marginalise", "maximise"])
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=20)
@given(data=st.data())
def test_sum_and_maximum_over_variables(kind: str, operation: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    gone = data.draw(st.lists(st.sampled_from(factor.scope), unique=True))
    combine = sum if operation == "marginalise" else max

    def number(at: dict[str, object]) -> float:
        return combine(look(table, {**at, **rest}) for rest in assignments(tuple(gone)))

    expect(getattr(factor, operation)(*gone), set(factor.names) - {v.name for v in gone}, number)


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25)
@given(data=st.data())
def test_condition(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    fixed = data.draw(st.lists(st.sampled_from(factor.scope), unique=True))
    at = {variable.name: data.draw(st.sampled_from(variable.values)) for variable in fixed}
    result = factor.condition({**at, "not in the scope": 1})
    expect(result, set(factor.names) - set(at), lambda rest: look(table, {**rest, **at}))


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=15)
@given(data=st.data())
def test_renamed(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    old = data.draw(st.sampled_from(factor.names))
    result = factor.renamed({old: "fresh", "not in the scope": "x"})
    assert result.storage == factor.storage
    names = (set(factor.names) - {old}) | {"fresh"}
    expect(result, names, lambda at: look(table, {(old if n == "fresh" else n): v for n, v in at.items()}))


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=25)
@given(data=st.data())
def test_substituted_by_a_function_of_another_variable(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    replaced = data.draw(st.sampled_from(factor.scope))
    by = data.draw(st.sampled_from([*factor.scope, *POOL, Variable("fresh", "xyz"), Variable(replaced.name, [7, 8])]))
    if by != replaced and by.name == replaced.name and by in factor.scope:
        return
    indexes = data.draw(st.lists(st.integers(0, replaced.size - 1), min_size=by.size, max_size=by.size))

    def number(at: dict[str, object]) -> float:
        inner = {**at, replaced.name: replaced.values[indexes[by.values.index(at[by.name])]]}
        return look(table, inner)

    expect(
        factor.substituted(replaced, by, np.array(indexes)), (set(factor.names) - {replaced.name}) | {by.name}, number
    )


@pytest.mark.property
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=15)
@given(data=st.data())
def test_array_over_puts_axes_in_the_order_asked_for(kind: str, data: st.DataObject) -> None:
    factor, table = data.draw(factors((kind,)))
    absent = next(variable for variable in POOL if variable not in factor.scope)
    order = data.draw(st.permutations([*factor.scope, absent]))
    array = factor.array_over(order)
    assert array.shape == tuple(1 if variable == absent else variable.size for variable in order)
    for at in assignments(factor.scope):
        place = tuple(0 if v == absent else v.values.index(at[v.name]) for v in order)
        assert array[place] == pytest.approx(look(table, at), abs=1e-12)


@pytest.mark.example
def test_product_of_tables_by_hand() -> None:
    a, b = Variable("a", [0, 1]), Variable("b", [0, 1])
    product = DenseFactor([a, b], [[1, 2], [3, 4]]).product(SparseFactor([b], [[1]], [10.0]))
    assert as_plain(product) == PlainTable(("a", "b"), {(0, 0): 0, (0, 1): 20, (1, 0): 0, (1, 1): 40})


@pytest.mark.example
def test_a_transposed_view_is_not_stored_as_its_original() -> None:
    a, b = Variable("a", [0, 1]), Variable("b", [0, 1])
    numbers = np.array([[1.0, 2.0], [3.0, 4.0]])
    one, other = DenseFactor([a, b], numbers), DenseFactor([a, b], numbers.T)
    assert one.storage != other.storage


@pytest.mark.example
def test_what_is_asked_of_a_factor_is_checked() -> None:
    a = Variable("a", ["x", "y"])
    factor = DenseFactor([a], [1, 2])
    with pytest.raises(ValueError, match="'a' has no value 'z'"):
        factor.condition({"a": "z"})
    with pytest.raises(ValueError, match="no value given for a"):
        factor.value({})
    with pytest.raises(ValueError, match=r"no variable 'b' in the scope \(there are: a\)"):
        factor.variable("b")
    with pytest.raises(ValueError, match=r"array of shape \(3,\) for \('a',\), whose sizes are \(2,\)"):
        DenseFactor([a], [1, 2, 3])


@pytest.mark.example
def test_too_large_a_table_is_refused_with_its_sizes_before_it_is_made() -> None:
    from factored_pomdp.errors import TooLarge

    wide = [Variable(name, range(10_000)) for name in "pq"]
    entry = SparseFactor(wide, [[1, 2]], [1.0])
    assert entry.marginalise(wide[0]).numbers.tolist() == [1.0]
    with pytest.raises(
        TooLarge, match=r"p \(10000\) × q \(10000\) would hold 100,000,000 numbers, more than 50,000,000"
    ):
        entry.dense()
