"""Equal blocks are one array, whatever their variables are called; blocks of another kind are another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.beliefs.stacks import stacks_of
from factored_pomdp.structure import structure_of
from tests.belief_steps import gap

MOVE = np.array([[0.75, 0.25], [0.5, 0.5]])
SIGHT = np.array([[0.8, 0.2], [0.4, 0.6]])


def fleet(moves: list[np.ndarray], **changes: Any) -> fp.FactoredPOMDP:
    """Trucks that break down, each with its own repair action, sensor and price."""
    names = [f"truck{k}" for k in range(len(moves))]
    values = changes.pop("values", [["runs", "broken"]] * len(moves))
    trucks = [fp.Variable(name, list(v)) for name, v in zip(names, values, strict=True)]
    given: dict[str, Any] = {
        "transition": {
            t.name: fp.table(t.name, f"{t.name}.do", f"{t.name}.next", values=np.stack([m, np.eye(2)[[0, 0]]], axis=1))
            for t, m in zip(trucks, moves, strict=True)
        },
        "observation": {f"{n}.light": fp.table(f"{n}.next", f"{n}.light", values=SIGHT.copy()) for n in names},
        "reward": {n: fp.table(n, f"{n}.do", values=np.array([[1.0, -1.0], [0.0, -1.0]])) for n in names},
        "initial": {n: [0.5, 0.5] for n in names},
    }
    return fp.FactoredPOMDP(
        states=trucks,
        actions=[fp.Variable(f"{name}.do", ["drive", "repair"]) for name in names],
        observations=[fp.Variable(f"{name}.light", ["green", "red"]) for name in names],
        **(given | changes),
    )


def sizes(model: fp.FactoredPOMDP) -> list[int]:
    return [len(stack.names) for stack in stacks_of(structure_of(model).blocks)]


@pytest.mark.example
def test_equal_tables_made_separately_are_one_array_with_a_column_for_each() -> None:
    model = fleet([MOVE.copy() for _ in range(4)])
    assert sizes(model) == [4]
    belief = fp.initial_belief(model)
    assert [array.shape for array in belief.arrays] == [(2, 4)]
    assert belief.blocks == (("truck0",), ("truck1",), ("truck2",), ("truck3",))
    (stack,) = stacks_of(structure_of(model).blocks)
    assert stack.own == {"truck0.do", "truck0.light"}
    assert stack.names[2]["truck0.do"] == "truck2.do"


@pytest.mark.example
def test_different_tables_values_or_prices_make_other_stacks() -> None:
    assert sizes(fleet([MOVE, MOVE[::-1], MOVE])) == [2, 1]
    assert sizes(fleet([MOVE] * 3, values=["ab", "cd", "ab"])) == [2, 1]
    prices = {
        n: fp.table(n, values=np.array([float(k // 2), 0.0])) for k, n in enumerate(["truck0", "truck1", "truck2"])
    }
    assert sizes(fleet([MOVE] * 3, reward=prices)) == [2, 1]


@pytest.mark.example
def test_a_shared_variable_is_not_an_own_one() -> None:
    one_hand = {
        f"truck{k}": fp.table(f"truck{k}", "truck0.do", f"truck{k}.next", values=np.stack([MOVE, np.eye(2)], axis=1))
        for k in range(2)
    }
    model = fleet([MOVE, MOVE], transition=one_hand, reward={})
    (stack,) = stacks_of(structure_of(model).blocks)
    assert stack.own == {"truck0.light"}


@pytest.mark.example
def test_members_with_own_actions_and_observations_step_as_alone() -> None:
    model = fleet([MOVE, MOVE[::-1], MOVE, MOVE])
    action = {f"truck{k}.do": ["drive", "repair", "drive", "repair"][k] for k in range(4)}
    seen = {"truck0.light": "red", "truck1.light": "green", "truck3.light": "green"}
    belief = fp.initial_belief(model).predict(action).condition(seen)
    np.testing.assert_allclose(belief.marginal("truck0"), np.array([0.625 * 0.2, 0.375 * 0.6]) / (0.125 + 0.225))
    np.testing.assert_allclose(belief.marginal("truck1"), [1.0, 0.0])
    np.testing.assert_allclose(belief.marginal("truck2"), [0.625, 0.375])
    np.testing.assert_allclose(belief.marginal("truck3"), [1.0, 0.0])
    joint = fp.JointBelief.initial(model).predict(action).condition(seen)
    assert gap(model, belief, joint) <= 1e-12


@pytest.mark.example
def test_own_known_variables_are_not_mixed_up_whatever_their_order() -> None:
    """Each bird has its own cage, open or shut; the cages are listed the other way round."""
    birds, cages = (
        (fp.Variable(f"bird{k}", [0, 1, 2]) for k in (1, 2)),
        [fp.Variable(f"cage{k}", ["open", "shut"]) for k in (2, 1)],
    )
    birds = list(birds)

    def fly(bird: int, cage: str) -> dict[int, float]:
        return {bird: 1.0} if cage == "shut" else {(bird + 1) % 3: 0.75, bird: 0.25}

    model = fp.FactoredPOMDP(
        states=[*cages, *birds],
        actions=[fp.Variable(f"set{k}", ["open", "shut"]) for k in (1, 2)],
        observations=[],
        transition={
            **{f"bird{k}": fp.table(f"bird{k}", f"cage{k}", values=fly) for k in (1, 2)},
            **{f"cage{k}": fp.table(f"set{k}", values=lambda to: to) for k in (1, 2)},
        },
        observation={},
        reward={
            f"r{k}": fp.table(f"bird{k}.next", f"cage{k}", values=lambda b, c: b * (2.0 if c == "shut" else 1.0))
            for k in (1, 2)
        },
        initial={"bird1": 0, "bird2": {1: 0.5, 2: 0.5}, "cage1": "open", "cage2": "shut"},
    )
    from solvers import DecomposedMyopic, JointMyopic

    belief, joint = fp.initial_belief(model), fp.JointBelief.initial(model)
    action = {"set1": "shut", "set2": "open"}
    assert DecomposedMyopic(model).value(belief, action) == pytest.approx(0.75 + 2 * 1.5)
    assert JointMyopic(model).value(joint, action) == pytest.approx(0.75 + 2 * 1.5)
    after = belief.predict(action).predict(action)
    np.testing.assert_allclose(after.marginal("bird1"), [0.25, 0.75, 0.0])
    np.testing.assert_allclose(after.marginal("bird2"), [0.375, 0.125, 0.5])
    assert gap(model, after, joint.predict(action).predict(action)) <= 1e-12


@pytest.mark.example
def test_own_alarms_are_read_by_their_own_names() -> None:
    """A known variable that a hidden one moves, one for each block, and no transition reads it."""
    model = fp.FactoredPOMDP(
        states=[
            *(fp.Variable(f"fire{k}", [0, 1]) for k in (1, 2)),
            *(fp.Variable(f"alarm{k}", [0, 1]) for k in (1, 2)),
        ],
        actions=[fp.Variable("wait", ["on"])],
        observations=[],
        transition={
            **{f"fire{k}": fp.table(f"fire{k}", values=lambda f: f) for k in (1, 2)},
            **{f"alarm{k}": fp.table(f"fire{k}.next", values=lambda f: {f: 0.75, 1 - f: 0.25}) for k in (1, 2)},
        },
        observation={},
        reward={},
        initial={"fire1": {0: 0.5, 1: 0.5}, "fire2": {0: 0.5, 1: 0.5}, "alarm1": 0, "alarm2": 0},
        known=["alarm1", "alarm2"],
    )
    belief = fp.initial_belief(model).predict("on").condition(known={"alarm1": 0, "alarm2": 1})
    assert len(belief.arrays) == 1
    np.testing.assert_allclose(belief.marginal("fire1"), [0.75, 0.25])
    np.testing.assert_allclose(belief.marginal("fire2"), [0.25, 0.75])
