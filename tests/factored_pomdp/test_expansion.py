"""The flat expansion and the joint belief against plain loops."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.expansion import estimate
from tests.plain import PlainModel
from tests.strategies import random_models


@pytest.mark.property
@settings(max_examples=40)
@given(random_models(most_states=3))
def test_expansion_is_what_plain_loops_give(model: fp.FactoredPOMDP) -> None:
    plain, flat = PlainModel(model), fp.joint(model)
    assert flat.actions == plain.actions
    assert flat.observations == plain.observations
    np.testing.assert_allclose(flat.initial, plain.start, atol=1e-12)
    for number, action in enumerate(plain.actions):
        moves = [[plain.moves(state, action, after) for after in plain.states] for state in plain.states]
        np.testing.assert_allclose(flat.transition[number].toarray(), moves, atol=1e-12)
        views = [[plain.sees(after, action, seen) for seen in plain.observations] for after in plain.states]
        np.testing.assert_allclose(flat.observation[number].toarray(), views, atol=1e-12)
        rewards = [plain.expected_reward(state, action) for state in plain.states]
        np.testing.assert_allclose(flat.reward[number], rewards, atol=1e-11)


@pytest.mark.property
@settings(max_examples=40)
@given(random_models(most_states=3), st.randoms(use_true_random=False), st.booleans())
def test_joint_belief_is_what_plain_loops_give(model: fp.FactoredPOMDP, random: object, sparse: bool) -> None:
    plain = PlainModel(model)
    action = random.choice(plain.actions)
    predicted = plain.predict(plain.start, action)
    belief = fp.JointBelief.initial(model, sparse=sparse).predict(action)
    np.testing.assert_allclose(belief.table.array_over(model.states).ravel(), predicted, atol=1e-12)
    seen = random.choice(plain.observations)
    posterior, probability = plain.condition(predicted, action, seen)
    assert belief.probability(seen) == pytest.approx(probability, abs=1e-12)
    assume(probability > 1e-9)
    np.testing.assert_allclose(belief.condition(seen).table.array_over(model.states).ravel(), posterior, atol=1e-10)


@pytest.mark.property
@settings(max_examples=40)
@given(random_models())
def test_estimate_is_never_below_what_is_made(model: fp.FactoredPOMDP) -> None:
    flat = fp.joint(model)
    matrices = [*flat.transition, *flat.observation]
    made = sum(m.data.nbytes + m.indices.nbytes for m in matrices) + flat.reward.nbytes + flat.initial.nbytes
    assert estimate(model) >= made


@pytest.mark.example
def test_tiger_by_hand() -> None:
    flat = fp.joint(fp.domain("tiger"))
    assert [action["act"] for action in flat.actions] == ["listen", "open-left", "open-right"]
    np.testing.assert_array_equal(flat.transition[0].toarray(), np.eye(2))
    np.testing.assert_array_equal(flat.transition[1].toarray(), np.full((2, 2), 0.5))
    np.testing.assert_allclose(flat.observation[0].toarray(), [[0.85, 0.15], [0.15, 0.85]])
    np.testing.assert_array_equal(flat.reward, [[-1, -1], [-100, 10], [10, -100]])
    assert flat.discount == 0.95


@pytest.mark.example
def test_too_large_is_refused_with_its_sizes() -> None:
    model = fp.domain("machine-repair", machines=12)
    with pytest.raises(fp.TooLarge, match=r"531,441 joint states, 4,096 joint actions.* bytes; 4,000,000,000 allowed"):
        fp.joint(model)
