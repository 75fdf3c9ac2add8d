"""Sparse sampling: wide enough it is the optimal value; what it finds that rollouts do not; what it says."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from solvers import DecomposedMyopic
from solvers.belief_tree import tree_values
from solvers.lookahead import Lookahead
from solvers.sparse_sampling import SparseSampling
from tests.belief_steps import multiplied
from tests.strategies import random_beliefs, random_models


@pytest.mark.property
@settings(max_examples=8)
@given(data=st.data())
def test_two_steps_ahead_it_estimates_the_optimal_value_of_each_action(data: st.DataObject) -> None:
    """At depth 2 the continuation is one step, which the myopic choice solves exactly: no maximum over estimates."""
    model = data.draw(random_models(most_states=3))
    assume(model.joint_states * model.joint_actions * model.joint_observations <= 20_000)
    belief = data.draw(random_beliefs(model))
    exact = tree_values(model, 2, multiplied(model, belief).ravel())
    solver = SparseSampling(model, depth=2, width=400, actions=model.joint_actions)
    found = solver.compared(belief)
    actions = fp.joint(model).actions
    for place, (action, _) in enumerate(found.actions):
        assert found.mean(place) == pytest.approx(exact[actions.index(action)], abs=5 * found.error(place) + 1e-9)


@pytest.mark.example
def test_tiger_three_steps_ahead_listens() -> None:
    """The exact value of three steps; the maximum over noisy estimates is too large, by less than 1 here."""
    solver = SparseSampling(fp.domain("tiger"), depth=3, width=12, actions=3, rng=np.random.default_rng(3))
    found = solver.compared(solver.start())
    assert found.actions[found.better_than_base(1.0)][0] == {"act": "listen"}
    exact = tree_values(fp.domain("tiger"), 3)
    error = found.mean(found.best) - exact.max()
    assert -5 * found.error(found.best) <= error <= 5 * found.error(found.best) + 1


@pytest.mark.example
def test_a_plan_that_the_myopic_policy_would_not_follow() -> None:
    """Three steps of nothing, then 10; a step aside pays 1 at any time, so rollouts turn aside and never get there."""
    room, step, light = (
        fp.Variable("room", range(4)),
        fp.Variable("step", ["aside", "on"]),
        fp.Variable("light", [0, 1]),
    )
    model = fp.FactoredPOMDP(
        states=[room, light],
        actions=[step],
        observations=[],
        transition={
            "room": lambda room, step: room + 1 if step == "on" and room < 3 else room,
            "light": fp.table("light", "light.next", values=[[0.5, 0.5], [0.5, 0.5]]),
        },
        observation={},
        reward={
            "aside": fp.table("step", values={"aside": 1.0, "on": 0.0}),
            "there": fp.table("room", "room.next", values=[[0] * 4, [0] * 4, [0, 0, 0, 10], [0] * 4]),
        },
        initial={"room": 0, "light": {0: 0.5, 1: 0.5}},
        discount=1.0,
    )
    belief = fp.initial_belief(model)
    assert Lookahead(model, horizon=3, scenarios=2).decide(belief).action == {"step": "aside"}
    decision = SparseSampling(model, depth=3, width=2).decide(belief)
    assert decision.action == {"step": "on"}
    assert decision.value == pytest.approx(10.0)
    assert "depth 3 and width 2" in decision.method
    assert "not proved" in decision.method


@pytest.mark.property
@settings(max_examples=5)
@given(data=st.data())
def test_a_depth_of_one_step_is_the_myopic_choice(data: st.DataObject) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    assert SparseSampling(model, depth=1).decide(belief) == DecomposedMyopic(model).decide(belief)
