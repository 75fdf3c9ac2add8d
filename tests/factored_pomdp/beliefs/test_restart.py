"""What the model calls impossible: said with block, action and observation, or a restart that leaves its mark."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp
from tests.lamp import lamp_model


def sure() -> fp.ProductBelief:
    """x is surely 0 and stays there, and is seen exactly; y is anything."""
    model = lamp_model(
        transition={
            "x": lambda x: {0: 1.0} if x == 0 else {0: 0.5, 1: 0.5},
            "y": lambda y: {y: 0.75, 1 - y: 0.25},
            "lamp": lambda press: press,
        },
        observation={"see.x": lambda x_next: x_next, "see.y": lambda y_next: {y_next: 0.75, 1 - y_next: 0.25}},
    )
    start = fp.initial_belief(model)
    arrays = [np.array([[1.0], [0.0]]) if "x" in block else np.array([[0.5], [0.5]]) for block in start.blocks]
    return start.with_arrays(arrays)


@pytest.mark.example
def test_an_impossible_observation_names_block_action_and_observation() -> None:
    with pytest.raises(fp.ImpossibleObservation) as raised:
        sure().predict({"press": 0}).condition({"see.x": 1, "see.y": 0})
    error = raised.value
    assert (error.block, error.action, error.observation) == (("x",), {"press": 0}, {"see.x": 1})
    assert str(error).startswith(
        "observation {'see.x': 1} has probability zero for block [x] after action {'press': 0}; the model calls it"
    )


@pytest.mark.example
def test_a_restart_gives_that_block_a_new_belief_and_the_belief_says_so() -> None:
    asked: list[tuple] = []

    def restart(block: tuple, predicted: np.ndarray, observation: Mapping, known: Mapping) -> Any:
        asked.append((block, predicted.tolist(), dict(observation), dict(known)))
        return [1.0, 3.0]

    predicted = sure().predict(1)
    after = predicted.condition({"see.x": 1, "see.y": 0}, restart=restart)
    assert asked == [(("x",), [1.0, 0.0], {"see.x": 1, "see.y": 0}, {"lamp": 1})]
    np.testing.assert_allclose(after.marginal("x"), [0.25, 0.75])
    np.testing.assert_allclose(after.marginal("y"), [0.75, 0.25])
    assert not after.exact
    assert after.approximations == ("restarted: x",)
    assert after.predict(0).condition({"see.x": 0}).approximations == ("restarted: x",)
    assert predicted.exact


@pytest.mark.example
def test_a_restart_is_not_asked_where_all_is_possible() -> None:
    def restart(*given: object) -> Any:
        raise AssertionError(given)

    assert sure().predict(0).condition({"see.x": 0, "see.y": 1}, restart=restart).exact


@pytest.mark.example
def test_a_restart_without_mass_is_refused() -> None:
    with pytest.raises(ValueError, match=r"restart of block \[x\] gave a belief without mass"):
        sure().predict(0).condition({"see.x": 1}, restart=lambda *given: np.zeros(2))


@pytest.mark.example
def test_only_the_contradicted_member_of_a_stack_restarts() -> None:
    names = [f"t{k}" for k in range(3)]
    model = fp.FactoredPOMDP(
        states=[fp.Variable(name, range(3)) for name in names],
        actions=[fp.Variable("wait", ["on"])],
        observations=[fp.Variable(f"o.{name}", range(3)) for name in names],
        transition={name: fp.table(name, values=lambda t: t) for name in names},
        observation={f"o.{name}": fp.table(f"{name}.next", values=lambda t: t) for name in names},
        reward={},
        initial={name: {0: 0.5, 1: 0.5} for name in names},
    )
    belief = fp.initial_belief(model).predict("on")
    assert len(belief.arrays) == 1
    after = belief.condition({"o.t0": 0, "o.t1": 2, "o.t2": 1}, restart=lambda block, *rest: np.array([0.0, 0.0, 1.0]))
    assert after.approximations == ("restarted: t1",)
    np.testing.assert_allclose(after.arrays[0], [[1, 0, 0], [0, 0, 1], [0, 1, 0]])
