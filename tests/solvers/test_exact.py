"""Incremental pruning against the tree of all beliefs, and against numbers worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from solvers.belief_tree import tree_values
from solvers.exact import Exact
from solvers.parsimonious import parsimonious
from solvers.solution import Limits
from tests.solvers.small_models import small_models
from tests.strategies import random_models


@pytest.mark.example
def test_tiger_by_hand() -> None:
    # One step: listen costs 1, a door is worth 0.5 · 10 - 0.5 · 100 = -45. Two: listen twice, -1 - 0.95.
    # Three: listen; after two equal sounds (0.85² + 0.15² = 0.745) the door is worth 10 - 110 · 0.0225 / 0.745.
    listen_then_open = 0.745 * (10 - 110 * 0.0225 / 0.745) + 0.255 * -1
    for horizon, value in ((1, -1.0), (2, -1.95), (3, -1.95 + 0.95**2 * listen_then_open)):
        assert Exact(fp.domain("tiger")).solve(Limits(horizon=horizon)).lower == pytest.approx(value, abs=1e-12)


@pytest.mark.property
@settings(max_examples=200)
@given(small_models(), st.integers(1, 4))
def test_equals_the_belief_tree(model: fp.FactoredPOMDP, horizon: int) -> None:
    decision = (policy := Exact(model).solve(Limits(horizon=horizon)).policy).decide(policy.start())
    worth = tree_values(model, horizon)
    assert decision.value == pytest.approx(worth.max(), abs=1e-8)
    assert worth[policy.flat.actions.index(dict(decision.action))] == pytest.approx(worth.max(), abs=1e-8)


@pytest.mark.property
@settings(max_examples=30)
@given(small_models(), st.integers(2, 4))
def test_equals_the_belief_tree_at_other_beliefs_and_steps_to_go(model: fp.FactoredPOMDP, horizon: int) -> None:
    policy = Exact(model).solve(Limits(horizon=horizon)).policy
    flat, rng = policy.flat, np.random.default_rng(0)
    reachable = flat.tables.class_of[flat.rank] == flat.class_at(flat.initial)
    belief = rng.dirichlet(np.ones(flat.size)) * reachable
    belief = belief / belief.sum()
    for steps in (1, horizon):
        assert policy.decide(belief, steps).value == pytest.approx(tree_values(model, steps, belief).max(), abs=1e-8)


@pytest.mark.property
@settings(max_examples=40)
@given(random_models(most_states=3), st.integers(1, 3))
def test_equals_the_belief_tree_with_known_variables_and_legal_actions(model: fp.FactoredPOMDP, horizon: int) -> None:
    assume(model.joint_states <= 18 and (model.joint_actions * model.joint_observations) ** (horizon - 1) <= 1500)
    solver = _solver_unless_hidden_variables_forbid(model)
    assume(solver is not None)
    values = tree_values(model, horizon)
    assert solver.solve(Limits(horizon=horizon)).lower == pytest.approx(values.max(), abs=1e-8)


def _solver_unless_hidden_variables_forbid(model: fp.FactoredPOMDP) -> Exact | None:
    try:
        return Exact(model)
    except ValueError as refusal:
        return None if model.legal and "cannot always tell" in str(refusal) else pytest.fail(str(refusal))


@pytest.mark.property
@settings(max_examples=100)
@given(st.integers(1, 5), st.integers(1, 40), st.integers(0, 2**32 - 1), st.booleans())
def test_parsimonious_set_has_the_same_maximum(states: int, number: int, seed: int, rounded: bool) -> None:
    rng = np.random.default_rng(seed)
    vectors = rng.normal(size=(number, states))
    vectors = np.round(vectors, 1) if rounded else vectors
    kept, _ = parsimonious(vectors)
    beliefs = np.vstack([np.eye(states), rng.dirichlet(np.ones(states), 300)])
    np.testing.assert_allclose((beliefs @ vectors[kept].T).max(axis=1), (beliefs @ vectors.T).max(axis=1), atol=1e-10)
    assert len(set(kept.tolist())) == len(kept)


@pytest.mark.example
def test_only_vectors_that_are_best_somewhere_stay() -> None:
    # The third is below no single one of the others, but nowhere above both; the fourth repeats the first.
    vectors = np.array([[4.0, 0.0, 0.0], [0.0, 4.0, 4.0], [1.5, 1.5, 1.5], [4.0, 0.0, 0.0]])
    assert sorted(map(tuple, vectors[parsimonious(vectors)[0]])) == [(0.0, 4.0, 4.0), (4.0, 0.0, 0.0)]
    in_two = np.array([[2.0, 0.0], [0.0, 2.0], [0.9, 0.9], [1.5, 1.5]])
    assert sorted(map(tuple, in_two[parsimonious(in_two)[0]])) == [(0.0, 2.0), (1.5, 1.5), (2.0, 0.0)]


@pytest.mark.example
def test_needs_a_horizon_and_says_so() -> None:
    with pytest.raises(ValueError, match="needs a horizon"):
        Exact(fp.domain("tiger")).solve(Limits())


@pytest.mark.example
def test_what_was_reached_in_time_is_a_policy() -> None:
    solution = Exact(fp.domain("machine-repair", machines=2)).solve(Limits(horizon=50, time_limit=1e-6))
    assert solution.stopped == "time limit"
    assert solution.policy.horizon == len(solution.policy.stages) < 50
    assert solution.notes == (f"{len(solution.policy.stages)} of 50 steps to go",)
