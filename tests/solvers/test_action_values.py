"""Every action's value, against hand-made numbers and against what the solvers choose."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from solvers.action_values import one_step_values, summed_values
from solvers.exact import Exact
from solvers.flat import flatten
from solvers.flat_belief import FlatBelief
from solvers.myopic import DecomposedMyopic
from solvers.myopic_joint import JointMyopic
from solvers.point_based import PointBased
from solvers.solution import Limits
from solvers.upper_bounds import QMDP


def by_action(valued: list[tuple[dict, float]]) -> dict[tuple, float]:
    return {tuple(action.values()): value for action, value in valued}


@pytest.mark.example
def test_tiger_one_step_ahead() -> None:
    solver = DecomposedMyopic(fp.domain("tiger"))
    values = by_action(solver.values(solver.start()))
    assert values == pytest.approx({("listen",): -1.0, ("open-left",): -45.0, ("open-right",): -45.0})


@pytest.mark.example
def test_tiger_two_steps_ahead_and_at_the_last_step() -> None:
    policy = Exact(fp.domain("tiger")).solve(Limits(horizon=2)).policy
    start = policy.start()
    # After listening, or after a door that puts the tiger back behind either: listen once more, -1.
    values = by_action(policy.values(start))
    assert values == pytest.approx({("listen",): -1.95, ("open-left",): -45.95, ("open-right",): -45.95})
    heard = start.predict("listen").condition("left")
    assert heard.marginal("tiger") == pytest.approx([0.85, 0.15])
    last = by_action(policy.values(heard))
    assert last == pytest.approx({("listen",): -1.0, ("open-left",): -83.5, ("open-right",): -6.5})


@pytest.mark.example
def test_a_policy_that_follows_an_upper_bound_tells_what_it_compares() -> None:
    policy = QMDP(fp.domain("tiger")).solve(Limits()).policy
    # A state that is known is worth 10 / (1 - 0.95) = 200.
    values = by_action(policy.values(policy.start()))
    assert values == pytest.approx({("listen",): 189.0, ("open-left",): 145.0, ("open-right",): 145.0}, abs=1e-6)


@pytest.mark.example
def test_beyond_enumeration_the_neighbours_of_the_best() -> None:
    solver = DecomposedMyopic(fp.domain("machine-repair", machines=18))
    valued = solver.values(solver.start())
    assert len(valued) == 19
    assert sorted(value for _, value in valued) == pytest.approx([15.0] * 18 + [18.0])


@pytest.mark.example
def test_what_is_not_legal_is_not_listed() -> None:
    left, right = fp.Variable("left", ["up", "down"]), fp.Variable("right", ["up", "down"])
    local = [fp.DenseFactor([left], [1.0, 2.0]), fp.DenseFactor([left, right], [[10.0, 20.0], [30.0, 40.0]])]
    rule = fp.DenseFactor([right], [0.0, 1.0])
    values = by_action(summed_values(local, [left, right], [rule], {}))
    assert values == {("up", "down"): 21.0, ("down", "down"): 42.0}


@pytest.mark.property
@pytest.mark.parametrize("steps", range(4))
def test_decomposed_and_joint_values_agree(steps: int) -> None:
    model, rng = fp.domain("machine-repair", machines=2), np.random.default_rng(steps)
    world, product, joint = fp.Simulation(model), DecomposedMyopic(model), JointMyopic(model)
    state, one, other = world.start(rng), product.start(), joint.start()
    for _ in range(steps):
        action = {variable.name: variable.values[int(rng.integers(variable.size))] for variable in model.actions}
        state, seen, _ = world.step(state, action, rng)
        one, other = one.predict(action).condition(seen), other.predict(action).condition(seen)
    assert by_action(product.values(one)) == pytest.approx(by_action(joint.values(other)), abs=1e-9)


@pytest.mark.property
def test_a_solved_policys_best_action_has_its_best_value() -> None:
    model = fp.domain("tiger")
    policy = PointBased(model).solve(Limits(precision=1e-4)).policy
    belief = policy.start()
    for heard in ["left", "left", "right", "left", "left"]:
        decision, values = policy.decide(belief), by_action(policy.values(belief))
        assert values[tuple(decision.action.values())] == pytest.approx(max(values.values()), abs=1e-3)
        assert max(values.values()) == pytest.approx(decision.value, abs=1e-3)
        belief = belief.predict("listen").condition(heard)


@pytest.mark.property
def test_what_is_read_back_is_told_apart() -> None:
    """With V = 1 wherever a belief lies in one class, a step is worth its reward and the discount."""
    model = fp.domain("surveillance", site="micro", targets=1)
    flat = flatten(model)
    belief = FlatBelief.initial(flat)

    def one(vector: np.ndarray) -> float:
        assert flat.class_at(vector) is not None
        assert vector.sum() == pytest.approx(1.0)
        return 1.0

    legal = flat.tables.legal[:, belief.vector > 0].all(axis=1)
    ahead = by_action(one_step_values(flat, belief.vector, legal, one))
    now = by_action(one_step_values(flat, belief.vector, legal, None))
    assert ahead == pytest.approx({action: value + model.discount for action, value in now.items()})
