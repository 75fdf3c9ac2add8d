"""The choice among joint actions: what is legal, what is preferred, and a hundred variables."""

from __future__ import annotations

import numpy as np
import pytest

from factored_pomdp.factors import DenseFactor, ExpectedNoisyOr
from factored_pomdp.factors.expected_noisy_or import WeightedCause
from factored_pomdp.variables import Variable
from solvers.maximise import ENUMERATED, maximise

P, Q = Variable("p", ["a", "b", "c"]), Variable("q", ["a", "b", "c"])
BOTH = DenseFactor([P, Q], [[1, 2, 9], [4, 8, 3], [7, 5, 6]])


def allow(variable: Variable, values: str) -> DenseFactor:
    return DenseFactor([variable], [float(value in values) for value in variable.values])


@pytest.mark.example
def test_only_legal_actions_are_chosen() -> None:
    assert maximise([BOTH], [P, Q]).action == {"p": "a", "q": "c"}
    assert maximise([BOTH], [P, Q], [allow(Q, "ab")]).action == {"p": "b", "q": "b"}
    assert maximise([BOTH], [P, Q], [allow(Q, "ab"), allow(P, "ac")]).action == {"p": "c", "q": "a"}
    assert maximise([BOTH], [P, Q], [allow(Q, "ab"), allow(P, "ac"), allow(Q, "bc")]).action == {"p": "c", "q": "b"}
    everything = maximise([BOTH], [P, Q], [allow(Q, "abc")])
    assert everything.value == everything.upper_bound == 9
    with pytest.raises(ValueError, match="no value of 'q' is legal"):
        maximise([BOTH], [P, Q], [allow(Q, "a"), allow(Q, "b")])


@pytest.mark.example
def test_a_preferred_value_is_kept_where_that_costs_nothing_and_may_be_illegal() -> None:
    flat = DenseFactor([P], [1, 1, 0])
    assert maximise([flat], [P, Q], prefer={"p": "b", "q": "c"}).action == {"p": "b", "q": "c"}
    assert maximise([flat], [P, Q], prefer={"p": "c"}).action == {"p": "a", "q": "a"}
    assert maximise([flat], [P, Q], [allow(P, "a")], prefer={"p": "b"}).action == {"p": "a", "q": "a"}


@pytest.mark.example
def test_actions_come_back_in_order_with_nothing_to_decide_too() -> None:
    found = maximise([], [Q, P], [allow(P, "c")])
    assert list(found.action.items()) == [("q", "a"), ("p", "c")]
    assert (found.value, found.proved) == (0.0, True)


def many(number: int) -> tuple[list[Variable], ExpectedNoisyOr]:
    """Cameras around a ring of cells, each preset covering three of them."""
    actions = [Variable(f"c{k}", ["left", "ahead", "right"]) for k in range(number)]
    rng = np.random.default_rng(3)
    cells = 2 * number
    covers = np.zeros((number, 3, cells))
    for k in range(number):
        for preset in range(3):
            covers[k, preset, (2 * k + np.arange(3) + 2 * preset - 2) % cells] = 0.9
    causes = [WeightedCause(a, covers[k], np.ones(cells)) for k, a in enumerate(actions)]
    return actions, ExpectedNoisyOr(rng.random(cells), causes, np.zeros(cells))


@pytest.mark.example
def test_a_hundred_variables_of_three_values() -> None:
    actions, cover = many(100)
    legal = [DenseFactor([a], [1.0, 1.0, 0.0]) for a in actions[:10]]
    prefer = {a.name: "left" for a in actions}
    found = maximise([cover, DenseFactor([actions[0]], [0.0, 100.0, 0.0])], actions, legal, prefer)
    assert found.action["c0"] == "ahead"
    assert all(found.action[a.name] != "right" for a in actions[:10])
    choice = {a.name: a.index(found.action[a.name]) for a in actions}
    assert found.value == pytest.approx(cover.at(choice) + 100, abs=1e-9)
    assert found.value < found.upper_bound <= cover.weights.sum() + 100
    assert "greedy" in found.method
    assert f"(not proved: within {found.gap:.6g} of the best)" in found.method


@pytest.mark.example
def test_enumeration_up_to_the_limit_and_greedy_beyond() -> None:
    actions, cover = many(11)
    assert 3**10 <= ENUMERATED < 3**11
    assert "greedy" in maximise([cover], actions).method
    fixed = maximise([cover], actions, [DenseFactor([actions[0]], [0.0, 1.0, 0.0])])
    assert fixed.method == "enumeration of 59,049 joint actions"
    assert fixed.action["c0"] == "ahead"
    assert fixed.value <= maximise([cover], actions).upper_bound + 1e-9


@pytest.mark.example
def test_more_forced_variables_than_an_array_has_axes() -> None:
    actions, cover = many(80)
    forced = [DenseFactor([a], [0.0, 1.0, 0.0]) for a in actions[2:]]
    found = maximise([cover], actions, forced)
    assert found.method == "enumeration of 9 joint actions"
    assert found.proved
