"""Rollout against the exact value of "first action, then myopic"; when it departs from the base; what it says."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from solvers import DecomposedMyopic, JointMyopic
from solvers.foresight.returns import Returns
from solvers.lookahead import Lookahead
from tests.belief_steps import multiplied
from tests.plain import PlainModel
from tests.solvers.followed_values import followed_values
from tests.strategies import random_beliefs, random_models


def doors(discount: float = 0.9) -> fp.FactoredPOMDP:
    """A corridor of rooms 0 to 4 in which one room may be walked a step: 1 pays a little, 4 pays a lot.

    From room 2 the myopic policy goes back to room 1 for 1 and stays there; two steps on, room 4 pays 5.
    """
    room = fp.Variable("room", range(5))
    step = fp.Variable("step", ["back", "on"])
    light = fp.Variable("light", ["red", "green"])
    return fp.FactoredPOMDP(
        name="doors",
        states=[room, light],
        actions=[step],
        observations=[],
        transition={
            "room": lambda room, step: max(1, room - 1) if step == "back" else min(4, room + 1),
            "light": fp.table("light", "light.next", values=[[0.5, 0.5], [0.5, 0.5]]),
        },
        observation={},
        reward=fp.table("room.next", values=[0.0, 1.0, 0.0, 0.0, 5.0]),
        initial={"room": 2, "light": {"red": 0.5, "green": 0.5}},
        discount=discount,
    )


@pytest.mark.property
@settings(max_examples=12)
@given(data=st.data(), horizon=st.integers(2, 3))
def test_estimates_are_the_exact_values_of_each_action_followed_by_the_myopic_policy(
    data: st.DataObject, horizon: int
) -> None:
    model = data.draw(random_models(most_states=3))
    sizes = model.joint_actions * model.joint_observations * model.joint_states
    assume(model.joint_states <= 18 and sizes ** (horizon - 1) <= 30_000)
    belief = data.draw(random_beliefs(model))
    solver = Lookahead(model, horizon, actions=model.joint_actions)
    exact = followed_values(model, multiplied(model, belief).ravel(), horizon)
    found = solver.returns(belief, solver.first_actions(belief), 400)
    numbers = {tuple(action.values()): number for number, action in enumerate(PlainModel(model).actions)}
    legal = {number for number, value in enumerate(exact) if value > -np.inf}
    assert {numbers[tuple(action.values())] for action, _ in found.actions} == legal
    for place, (action, _) in enumerate(found.actions):
        allowed = 5 * found.error(place) + 1e-9
        assert found.mean(place) == pytest.approx(exact[numbers[tuple(action.values())]], abs=allowed)


@pytest.mark.property
@settings(max_examples=8)
@given(data=st.data())
def test_a_horizon_of_one_step_is_the_myopic_choice(data: st.DataObject) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    ahead, myopic = Lookahead(model, horizon=1).decide(belief), DecomposedMyopic(model).decide(belief)
    assert ahead == myopic
    assert ahead.proved


@pytest.mark.property
@settings(max_examples=10)
@given(data=st.data())
def test_what_is_certain_is_found_exactly(data: st.DataObject) -> None:
    """With one scenario more than needed nothing else can happen: all hidden variables start and stay as they are."""
    rewards = np.array(data.draw(st.lists(st.integers(-5, 5), min_size=10, max_size=10)), dtype=float)
    room, other = fp.Variable("room", range(5)), fp.Variable("other", range(2))
    step = fp.Variable("step", [-1, 0, 1])
    model = fp.FactoredPOMDP(
        states=[room, other],
        actions=[step],
        observations=[],
        transition={"room": lambda room, step: (room + step) % 5, "other": lambda other: other},
        observation={},
        reward=fp.table("room.next", "other", values=rewards.reshape(5, 2)),
        initial={"room": 0, "other": {0: 0.0, 1: 1.0}},
        discount=0.5,
    )
    solver = Lookahead(model, horizon=3, scenarios=2)
    belief = solver.start()
    exact = followed_values(model, multiplied(model, belief).ravel(), 3)
    found = solver.returns(belief, solver.first_actions(belief), 2)
    for place, (action, _) in enumerate(found.actions):
        assert found.samples[:, place] == pytest.approx([exact[action["step"] + 1]] * 2, abs=1e-12)


@pytest.mark.example
def test_values_are_those_that_the_decision_was_made_by_and_asking_changes_nothing() -> None:
    model = fp.domain("machine-repair")
    asked, silent = Lookahead(model), Lookahead(model)
    belief = asked.start()
    for _ in range(3):
        decision = asked.decide(belief)
        valued = asked.values(belief)
        assert len(valued) == 8
        assert decision.value in [value for action, value in valued if action == decision.action]
        assert silent.decide(belief) == decision
        belief = belief.predict(decision.action)
    assert len(Lookahead(model, horizon=1).values(belief)) == model.joint_actions


@pytest.mark.example
def test_it_walks_past_a_small_reward_to_a_large_one() -> None:
    """Over three steps: back, then staying, 1 + 0.9 + 0.81; on (0), then on as the myopic policy then does, 5 and 5."""
    model = doors()
    belief = fp.initial_belief(model)
    assert DecomposedMyopic(model).decide(belief).action == {"step": "back"}
    solver = Lookahead(model, horizon=3, scenarios=2)
    decision = solver.decide(belief)
    assert decision.action == {"step": "on"}
    assert decision.value == pytest.approx(0.9 * 5 + 0.81 * 5)
    assert dict((action["step"], value) for action, value in solver.values(belief)) == {
        "back": pytest.approx(1 + 0.9 + 0.81),
        "on": pytest.approx(9 * 0.95),
    }


@pytest.mark.example
def test_the_decision_says_that_it_is_a_statistic_and_not_proved() -> None:
    decision = Lookahead(doors(), horizon=3, scenarios=8).decide(fp.initial_belief(doors()))
    assert "8 scenarios" in decision.method
    assert "3 steps" in decision.method
    assert "standard error 0" in decision.method
    assert "not proved" in decision.method
    assert decision.upper_bound == math.inf
    assert not decision.proved


@pytest.mark.example
def test_the_base_stands_unless_it_is_surely_behind() -> None:
    """Differences 3, -1, 1, 1: mean 1, standard error 1.633 / 2 = 0.8165."""
    samples = np.array([[0.0, 3.0], [1.0, 0.0], [0.0, 1.0], [1.0, 2.0]])
    found = Returns((({"a": 0}, 0.0), ({"a": 1}, 0.0)), samples)
    assert found.lead(1) == (pytest.approx(1.0), pytest.approx(0.8165, abs=1e-4))
    assert found.best == 1
    assert (found.better_than_base(1.0), found.better_than_base(1.5)) == (1, 0)
    assert found.contenders(1.0) == [0, 1]
    behind = Returns(found.actions, samples[:, ::-1])
    assert behind.contenders(1.0) == [0]
    assert behind.contenders(2.0) == [0, 1]
    assert behind.better_than_base(0.0) == 0


@pytest.mark.example
def test_the_same_seed_gives_the_same_decision_and_another_one_another_value() -> None:
    model = fp.domain("machine-repair", machines=3)

    def value(seed: int) -> float:
        return Lookahead(model, rng=np.random.default_rng(seed)).decide(fp.initial_belief(model)).value

    assert value(1) == value(1)
    assert value(1) != value(2)


@pytest.mark.example
def test_where_a_known_value_was_not_read_it_looks_one_step_ahead() -> None:
    model = fp.domain("surveillance", site="micro", targets=2)
    solver = Lookahead(model)
    belief = fp.initial_belief(model)
    away = belief.with_arrays(belief.arrays, {**belief.known, "east.preset": None})
    decision = solver.decide(away)
    assert decision.action == DecomposedMyopic(model).decide(away).action
    assert "east.preset was not read back" in decision.method


@pytest.mark.example
def test_where_blocks_came_or_went_it_looks_one_step_ahead() -> None:
    model = fp.domain("machine-repair", machines=3)
    solver = Lookahead(model)
    belief = fp.initial_belief(model)
    gone = belief.blocks[1][0]
    decision = solver.decide(belief.without_block(gone))
    assert f"{gone} is in the belief or in the model, but not in both" in decision.method
    assert decision.action == DecomposedMyopic(model).decide(belief.without_block(gone)).action


@pytest.mark.example
def test_returns_end_with_the_episode() -> None:
    """Leaving pays 10 and ends it; staying pays 1 a step. After leaving nothing more is earned."""
    place, go, sound = (
        fp.Variable("place", ["in", "out"]),
        fp.Variable("go", ["stay", "leave"]),
        fp.Variable("h", [0, 1]),
    )
    model = fp.FactoredPOMDP(
        states=[place, sound],
        actions=[go],
        observations=[],
        transition={
            "place": lambda place, go: "out" if place == "out" or go == "leave" else "in",
            "h": fp.table("h", "h.next", values=[[0.5, 0.5], [0.5, 0.5]]),
        },
        observation={},
        reward=fp.table("go", values={"stay": 1.0, "leave": 10.0}),
        initial={"place": "in", "h": 0},
        discount=1.0,
        terminal={"place": fp.table("place", values={"in": 0.0, "out": 1.0})}["place"],
    )
    solver = Lookahead(model, horizon=4, scenarios=2)
    found = solver.returns(solver.start(), [({"go": "leave"}, 10.0), ({"go": "stay"}, 1.0)], 2)
    assert found.samples.tolist() == [[10.0, 11.0], [10.0, 11.0]]


@pytest.mark.example
def test_it_refuses_wrong_numbers_all_at_once_and_models_that_the_base_refuses() -> None:
    with pytest.raises(ValueError, match=r"steps 0: expected at least 1; scenarios 1.*; actions 0.*; margin -1"):
        Lookahead(doors(), horizon=0, scenarios=1, actions=0, margin=-1.0)
    large = fp.domain("surveillance", site="hall", targets=2)
    ability = Lookahead.can_solve(large)
    assert ability.can
    assert "2 block(s), the largest with 1,600 states" in ability.because
    assert ability.estimate == f"up to {8 * 32 * 4:,} steps of the belief a decision, {8 * 3200 * 64:,} bytes"


@pytest.mark.property
@settings(max_examples=5)
@given(data=st.data())
def test_the_myopic_action_comes_first_then_its_neighbours(data: st.DataObject) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    solver = Lookahead(model, actions=3)
    found = solver.first_actions(belief)
    base = DecomposedMyopic(model).decide(belief)
    assert found[0][0] == base.action
    changes = [sum(value != base.action[name] for name, value in action.items()) for action, _ in found]
    assert changes == sorted(changes)
    literal = JointMyopic(model)
    for action, value in found:
        joint = fp.JointBelief(model, fp.DenseFactor(model.states, multiplied(model, belief)))
        assert value == pytest.approx(literal.value(joint, action), abs=1e-9)
        assert model.is_legal(action, belief.known)
