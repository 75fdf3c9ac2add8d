"""Noisy-or: causes that act independently, and thirty of them where no table could be made."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import Cause, ExpectedNoisyOr, NoisyOr
from factored_pomdp.variables import Variable
from tests.factor_strategies import plain_noisy_or

PLACE = Variable("place", ["here", "there"])
SEEN = Variable("seen", ["here", "there", "nothing"])
EXACT = sparse.csr_array(np.array([[1.0, 0, 0], [0, 1.0, 0]]))


def camera(name: str, left: float, right: float) -> Cause:
    """A camera with two presets, of which each sees one place."""
    return Cause(Variable(name, ["left", "right"]), np.array([[left, 0.0], [0.0, right]]), EXACT)


@pytest.mark.example
def test_two_cameras_by_hand() -> None:
    noisy = NoisyOr([PLACE], SEEN, "nothing", [camera("one", 0.8, 0.6), camera("two", 0.5, 0.5)])
    at = {"place": "here", "one": "left", "two": "left"}
    assert noisy.value({**at, "seen": "here"}) == pytest.approx(0.9)
    assert noisy.value({**at, "seen": "nothing"}) == pytest.approx(0.1)
    assert noisy.value({**at, "seen": "there"}) == 0.0
    assert noisy.value({**at, "two": "right", "seen": "here"}) == pytest.approx(0.8)


@pytest.mark.example
def test_an_absent_cause_never_acts() -> None:
    noisy = NoisyOr([PLACE], SEEN, "nothing", [camera("one", 0.8, 0.6), camera("two", 0.5, 0.5)])
    without = noisy.condition({"one": None, "two": "left"})
    alone = NoisyOr([PLACE], SEEN, "nothing", [camera("two", 0.5, 0.5)]).condition({"two": "left"})
    np.testing.assert_allclose(without.array_over([PLACE, SEEN]), alone.array_over([PLACE, SEEN]))


@pytest.mark.example
def test_the_first_acting_cause_decides_what_is_seen() -> None:
    swapped = sparse.csr_array(np.array([[0, 1.0, 0], [1.0, 0, 0]]))
    on = Variable("on", [True])
    noisy = NoisyOr(
        [PLACE], SEEN, "nothing", [Cause(on, np.array([[0.5, 0.5]]), EXACT), Cause(None, np.ones((1, 2)), swapped)]
    )
    here = noisy.condition({"on": True, "place": "here"}).array_over([SEEN])
    assert here.tolist() == [0.5, 0.5, 0.0]


def thirty() -> NoisyOr:
    rng = np.random.default_rng(5)
    return NoisyOr([PLACE], SEEN, "nothing", [camera(f"c{k}", *rng.random(2)) for k in range(30)])


@pytest.mark.example
def test_thirty_causes_where_a_table_would_hold_six_billion_numbers() -> None:
    noisy = thirty()
    assert noisy.size == 6 * 2**30
    assert noisy.stored == 30 * (4 + 2)
    with pytest.raises(TooLarge, match="over 30 causes"):
        noisy.sparse()
    values = {f"c{k}": ["left", "right"][k % 2] for k in range(30)}
    table = noisy.condition(values)
    for place in PLACE.values:
        for seen in SEEN.values:
            at = {"place": place, "seen": seen}
            assert table.value(at) == pytest.approx(plain_noisy_or(noisy, {**values, **at}), abs=1e-12)


@pytest.mark.example
def test_thirty_causes_are_not_expanded_to_fix_their_context_or_to_sum_out_the_child() -> None:
    noisy = thirty()
    here = noisy.condition({"place": "here"})
    assert isinstance(here, NoisyOr)
    assert here.context == ()
    values = {f"c{k}": "left" for k in range(30)}
    assert here.value({**values, "seen": "here"}) == pytest.approx(
        plain_noisy_or(noisy, {**values, "place": "here", "seen": "here"})
    )
    some = noisy.condition({f"c{k}": "left" for k in range(25)})
    assert some.condition({"seen": "nothing"}).scope == (PLACE, *(c.variable for c in noisy.causes[25:]))
    np.testing.assert_allclose(some.marginalise(SEEN).dense().array, 1.0)


@pytest.mark.example
def test_thirty_causes_weighed_by_a_belief_stay_thirty_rows() -> None:
    noisy, weights = thirty(), np.array([0.3, 0.7])
    cover = ExpectedNoisyOr.of(noisy, weights, np.array([[1.0, 1.0, 0.0]]))
    assert cover.stored == 30 * 4
    choice = {f"c{k}": k % 2 for k in range(30)}
    values = {f"c{k}": ["left", "right"][k % 2] for k in range(30)}
    by_hand = sum(
        weight * (1 - plain_noisy_or(noisy, {**values, "place": place, "seen": "nothing"}))
        for weight, place in zip(weights, PLACE.values, strict=True)
    )
    assert cover.at(choice) == pytest.approx(by_hand, abs=1e-12)
    assert cover.condition(values).value({}) == pytest.approx(by_hand, abs=1e-12)


@pytest.mark.example
def test_one_action_behind_two_causes() -> None:
    noisy = NoisyOr([PLACE], SEEN, "nothing", [camera("one", 0.8, 0.6), camera("two", 0.5, 0.5)])
    cover = ExpectedNoisyOr.of(noisy, np.array([0.25, 0.75]), np.array([[1.0, 1.0, 0.0]]))
    both = Variable("both", ["apart", "together"])
    moved = cover.substituted(Variable("one", ["left", "right"]), both, np.array([0, 0]))
    moved = moved.substituted(Variable("two", ["left", "right"]), both, np.array([1, 0]))
    assert moved.scope == (both,)
    # apart: here with 0.8, there with 0.5; together: both look here, 1 - 0.2 * 0.5
    np.testing.assert_allclose(moved.dense().array, [0.25 * 0.8 + 0.75 * 0.5, 0.25 * 0.9])


@pytest.mark.example
def test_a_name_twice_and_wrong_shapes_are_refused() -> None:
    with pytest.raises(ValueError, match="one more than once among context and causes"):
        NoisyOr([PLACE], SEEN, "nothing", [camera("one", 0.8, 0.6), camera("one", 0.5, 0.5)])
    with pytest.raises(ValueError, match=r"activation of one: shape \(2, 2\), expected \(2, 1\)"):
        NoisyOr([], SEEN, "nothing", [camera("one", 0.8, 0.6)])
    with pytest.raises(ValueError, match="'seen' has no value 'off'"):
        NoisyOr([PLACE], SEEN, "off", [camera("one", 0.8, 0.6)])
