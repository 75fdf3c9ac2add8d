"""The product belief against the joint one, step by step; it is pure, and says what was impossible."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from tests.belief_steps import gap, joint_of, next_step
from tests.lamp import lamp_model
from tests.strategies import random_beliefs, random_models, random_module_as_found


@pytest.mark.property
@settings(max_examples=25)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_product_and_joint_belief_agree_step_by_step(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    rng = np.random.default_rng(seed)
    skip = 0.0 if fp.decompose(model, counterexamples=False).structure.shown_by else 0.4
    joint = joint_of(model, belief)
    for _ in range(3):
        step = next_step(model, joint, rng, skip)
        belief = belief.predict(step.action).condition(step.observation, known=step.read)
        joint = joint.predict(step.action).condition(step.observation, known=step.read)
        assert gap(model, belief, joint) <= 1e-9
        assert belief.exact


@pytest.mark.property
@settings(max_examples=15)
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_nothing_is_changed_in_place(data: st.DataObject, seed: int) -> None:
    model = data.draw(random_models(most_states=3))
    belief = data.draw(random_beliefs(model))
    step = next_step(model, joint_of(model, belief), np.random.default_rng(seed))
    predicted = belief.predict(step.action)
    kept = [[array.copy() for array in one.arrays] for one in (belief, predicted)]
    known = [dict(belief.known), dict(predicted.known)]
    once = predicted.condition(step.observation, known=step.read)
    again = belief.predict(step.action).condition(step.observation, known=step.read)
    with random_module_as_found():
        for one, arrays, values in zip((belief, predicted), kept, known, strict=True):
            assert dict(one.known) == values
            assert all(np.array_equal(now, then) for now, then in zip(one.arrays, arrays, strict=True))
    assert all(np.array_equal(a, b) for a, b in zip(once.arrays, again.arrays, strict=True))


@pytest.mark.example
def test_a_step_by_hand() -> None:
    belief = fp.initial_belief(lamp_model(initial={"x": {0: 1.0}, "y": {0: 0.8, 1: 0.2}, "lamp": 0}))
    predicted = belief.predict(1)
    assert predicted.known == {"lamp": 1}
    np.testing.assert_allclose(predicted.marginal("x"), [0.75, 0.25])
    np.testing.assert_allclose(predicted.marginal("y"), [0.8, 0.2])  # the lamp was off when y moved
    after = predicted.condition({"see.x": 1, "see.y": 0})
    np.testing.assert_allclose(after.marginal("x"), [0.0, 1.0])
    np.testing.assert_allclose(after.marginal("y"), [12 / 13, 1 / 13])
    np.testing.assert_allclose(after.predict(1).marginal("y"), [37 / 52, 15 / 52])  # now it is on


@pytest.mark.example
def test_what_was_not_looked_at_says_nothing() -> None:
    belief = fp.initial_belief(lamp_model()).predict(0)
    after = belief.condition({"see.y": 1})
    np.testing.assert_allclose(after.marginal("x"), belief.marginal("x"))
    np.testing.assert_allclose(after.marginal("y"), [0.25, 0.75])
    np.testing.assert_allclose(belief.condition().marginal("y"), belief.marginal("y"))
