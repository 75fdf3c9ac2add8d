"""The beliefs of many scenarios are, one by one, those of predict and condition; and so is the myopic choice."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from solvers import DecomposedMyopic
from solvers.foresight.crowd import Crowd
from solvers.foresight.one_step_tables import OneStepTables
from solvers.foresight.scenarios import Scenarios
from solvers.foresight.worlds import Worlds
from tests.plain import PlainModel
from tests.strategies import random_beliefs, random_models

SCENARIOS = 6


def imagined(model: fp.FactoredPOMDP, belief: fp.ProductBelief, seed: int) -> tuple[Crowd, list[fp.ProductBelief]]:
    """Beliefs after two steps of random actions, together and one by one."""
    rng = np.random.default_rng(seed)
    worlds, crowd, apart = Worlds(model), Crowd.of(belief, SCENARIOS), [belief] * SCENARIOS
    states = worlds.drawn(belief, SCENARIOS, rng)
    for _ in range(2):
        actions = {v.name: rng.integers(v.size, size=SCENARIOS) for v in model.actions}
        states, seen = worlds.step(states, actions, rng.random((worlds.numbers, SCENARIOS)))
        known = {name: states[name] for name in crowd.known}
        crowd = crowd.after(actions, known, seen)
        for number in range(SCENARIOS):
            action, shown, read = (
                {name: model.variable(name).values[int(place[number])] for name, place in places.items()}
                for places in (actions, seen, known)
            )
            apart[number] = apart[number].predict(action).condition(shown, known=read)
    return crowd, apart


@pytest.mark.property
@settings(max_examples=20)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_equals_predict_and_condition_scenario_by_scenario(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=4))
    crowd, apart = imagined(model, data.draw(random_beliefs(model)), seed)
    for number, belief in enumerate(apart):
        found = crowd.belief(number)
        assert found.known == belief.known
        for array, expected in zip(found.arrays, belief.arrays, strict=True):
            np.testing.assert_allclose(array, expected, atol=1e-9)
    some = crowd.some(np.arange(SCENARIOS) % 2 == 1)
    assert some.scenarios == SCENARIOS // 2
    for array, expected in zip(some.belief(1).arrays, crowd.belief(3).arrays, strict=True):
        np.testing.assert_array_equal(array, expected)


@pytest.mark.property
@settings(max_examples=8)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_tables_value_every_action_as_the_solver_does(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=3))
    crowd, apart = imagined(model, data.draw(random_beliefs(model)), seed)
    myopic = DecomposedMyopic(model)
    values = OneStepTables(myopic).values(crowd)
    for number, belief in enumerate(apart):
        expected = [myopic.value(belief, action) for action in PlainModel(model).actions]
        np.testing.assert_allclose(values[:, number], expected, atol=1e-9)


@pytest.mark.property
@settings(max_examples=8)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_the_choice_by_tables_is_the_choice_one_by_one(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=3))
    crowd, apart = imagined(model, data.draw(random_beliefs(model)), seed)
    myopic = DecomposedMyopic(model)
    together, alone = (Scenarios(myopic, {}, tables=tables).chosen(crowd) for tables in (True, False))
    np.testing.assert_allclose(together.values, alone.values, atol=1e-9)
    for number, belief in enumerate(apart):
        worth = sorted(worth for _, worth in myopic.values(belief))
        assume(len(worth) < 2 or not 1e-12 < worth[-1] - worth[-2] < 1e-8)
        assert {n: p[number] for n, p in together.actions.items()} == {n: p[number] for n, p in alone.actions.items()}


@pytest.mark.example
def test_equals_keep_the_present_value_in_both_ways() -> None:
    """Nothing pays, so all actions are equal: the camera keeps its preset wherever it stands."""
    preset = fp.Variable("preset", ["a", "b", "c"])
    spot = fp.Variable("spot", ["x", "y"])
    model = fp.FactoredPOMDP(
        states=[preset, spot],
        actions=[preset.renamed("move")],
        observations=[],
        transition={"preset": lambda move: move, "spot": fp.table("spot", "spot.next", values=[[0.5, 0.5]] * 2)},
        observation={},
        reward=fp.table("spot.next", values=[1.0, 1.0]),
        initial={"preset": "a", "spot": "x"},
        discount=0.9,
    )
    belief = fp.initial_belief(model)
    crowd = Crowd.of(belief, 3).after({"move": np.array([2, 0, 1])}, {"preset": np.array([2, 0, 1])}, {})
    for tables in (True, False):
        chosen = Scenarios(DecomposedMyopic(model), {"move": "preset"}, tables=tables).chosen(crowd)
        assert chosen.actions["move"].tolist() == [2, 0, 1]
        assert chosen.values.tolist() == pytest.approx([1.0, 1.0, 1.0])
