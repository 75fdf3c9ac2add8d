"""What bounds the value from above and below: mdp, qmdp, the fast informed bound, blind policies, classes of states."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from solvers import FIB, MDP, QMDP, Limits
from solvers.belief_tree import tree_values
from solvers.blind import blind_values
from solvers.flat import flatten
from solvers.mdp import linear_program, state_values
from solvers.upper_bounds import informed_vectors, qmdp_vectors
from tests.solvers.small_models import small_models


@pytest.mark.example
def test_tiger_by_hand() -> None:
    # Seen, the tiger's door is never opened: 10 a step, 10 / 0.05 = 200. QMDP listens once: -1 + 0.95 · 200.
    # Blind: listening for ever, -1 / 0.05.
    tiger = fp.domain("tiger")
    assert MDP(tiger).solve().upper == pytest.approx(200)
    assert QMDP(tiger).solve().upper == pytest.approx(189)
    for solver in (MDP, QMDP, FIB):
        assert solver(tiger).solve().lower == pytest.approx(-20)
    assert 19.3714 < FIB(tiger).solve().upper < 100


@pytest.mark.property
@settings(max_examples=25)
@given(small_models())
def test_value_iteration_agrees_with_the_linear_program(model: fp.FactoredPOMDP) -> None:
    flat = flatten(model)
    value, program = state_values(flat), linear_program(flat)
    np.testing.assert_allclose(value, program, atol=1e-6)
    backed_up = (flat.reward + 0.9 * np.stack([moves @ value for moves in flat.transition])).max(axis=0)
    assert (backed_up <= value + 1e-12).all(), "an upper bound does not grow when it is backed up"


@pytest.mark.property
@settings(max_examples=25)
@given(small_models())
def test_bounds_stand_in_order(model: fp.FactoredPOMDP) -> None:
    flat, rng = flatten(model), np.random.default_rng(0)
    reach = 0.9**4 * np.abs(flat.reward).max() / 0.1
    for belief in rng.dirichlet(np.ones(flat.size), 5):
        value = tree_values(model, 4, belief[flat.rank]).max()
        informed = (informed_vectors(flat) @ belief).max()
        qmdp = (qmdp_vectors(flat) @ belief).max()
        assert (blind_values(flat) @ belief).max() <= value + reach + 1e-9
        assert value - reach - 1e-9 <= informed <= qmdp + 1e-9
        assert qmdp <= state_values(flat) @ belief + 1e-9


@pytest.mark.property
@settings(max_examples=25)
@given(small_models())
def test_finite_horizons_bound_the_belief_tree(model: fp.FactoredPOMDP) -> None:
    value = tree_values(model, 3).max()
    found = [solver(model).solve(Limits(horizon=3)) for solver in (FIB, QMDP, MDP)]
    assert all(solution.lower <= value + 1e-9 for solution in found)
    assert value - 1e-9 <= found[0].upper <= found[1].upper + 1e-9 <= found[2].upper + 2e-9


@pytest.mark.example
def test_policies_act() -> None:
    tiger = fp.domain("tiger")
    qmdp = QMDP(tiger).solve().policy
    assert qmdp.decide(qmdp.start()).action == {"act": "listen"}
    assert qmdp.decide(np.array([0.01, 0.99])).action == {"act": "open-left"}
    assert MDP(tiger).solve().policy.decide(np.array([0.51, 0.49])).action == {"act": "open-right"}


@pytest.mark.example
def test_discount_of_one_needs_a_horizon() -> None:
    with pytest.raises(ValueError, match="discount 1"):
        QMDP(fp.domain("tiger", discount=1.0)).solve()
    assert QMDP(fp.domain("tiger", discount=1.0)).solve(Limits(horizon=1)).upper == pytest.approx(-1)


@pytest.mark.example
def test_what_the_agent_can_tell_makes_classes() -> None:
    # A position on a line of three, moved by the action and not observed, and a hidden coin: position is known.
    model = fp.FactoredPOMDP(
        name="line",
        states=[fp.Variable("place", range(3)), fp.Variable("coin", ["heads", "tails"])],
        actions=[fp.Variable("go", [-1, 1])],
        observations=[fp.Variable("seen", ["heads", "tails"])],
        transition={"place": lambda place, go: min(2, max(0, place + go)), "coin": lambda coin: coin},
        observation={"seen": lambda coin_next: {"heads": 0.6, "tails": 0.4} if coin_next == "heads" else "tails"},
        reward=lambda place, coin: float(place == 2 and coin == "heads"),
        initial={"place": 0, "coin": {"heads": 0.5, "tails": 0.5}},
        discount=0.9,
    )
    flat = flatten(model)
    assert flat.tables.class_start.tolist() == [0, 2, 4, 6]
    # Tiger: hidden altogether, one class.
    assert flatten(fp.domain("tiger")).tables.class_start.tolist() == [0, 2]


@pytest.mark.property
@settings(max_examples=25)
@given(small_models(most_states=4))
def test_beliefs_never_leave_their_class(model: fp.FactoredPOMDP) -> None:
    flat, rng = flatten(model), np.random.default_rng(1)
    belief = flat.initial
    for _ in range(15):
        action = rng.integers(len(flat.actions))
        moved = belief @ flat.transition[action]
        views = flat.observation[action].toarray()
        belief = moved * views[:, rng.choice(views.shape[1], p=moved @ views)]
        belief = belief / belief.sum()
        assert flat.class_at(belief) is not None
