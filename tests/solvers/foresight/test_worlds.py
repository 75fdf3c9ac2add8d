"""Many worlds at once draw what one world draws: by evenly spread numbers, by hand, and beside the joint belief."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import factored_pomdp as fp
from solvers.foresight.worlds import Worlds
from tests.strategies import random_models


@pytest.mark.property
@settings(max_examples=8)
@given(random_models(most_states=3), st.integers(0, 2**32 - 1))
def test_joint_states_and_observations_come_as_often_as_the_expansion_says(model: fp.FactoredPOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    worlds, runs = Worlds(model), 4000
    sizes = [v.size for v in model.states]
    state = [int(rng.integers(size)) for size in sizes]
    action = {v.name: int(rng.integers(v.size)) for v in model.actions}
    states = {v.name: np.full(runs, place) for v, place in zip(model.states, state, strict=True)}
    actions = {name: np.full(runs, place) for name, place in action.items()}
    after, seen = worlds.step(states, actions, rng.random((worlds.numbers, runs)))
    joint = fp.joint(model)
    number = joint.actions.index({v.name: v.values[action[v.name]] for v in model.actions})
    moves = joint.transition[number].toarray()[np.ravel_multi_index(state, sizes)]
    expected = moves[:, None] * joint.observation[number].toarray()
    rows = np.ravel_multi_index([after[v.name] for v in model.states], sizes)
    columns = np.ravel_multi_index([seen[v.name] for v in model.observations], [v.size for v in model.observations])
    drawn = np.zeros(expected.shape)
    np.add.at(drawn, (rows, columns), 1 / runs)
    assert np.abs(drawn - expected).max() <= 5 * 0.5 / np.sqrt(runs)
    assert (expected[drawn > 0] > 0).all()


@pytest.mark.example
def test_a_table_is_cut_where_its_running_total_says() -> None:
    """P(next | now = 0) = 0.2, 0, 0.8: numbers below 0.2 give the first value, all others the third."""
    x = fp.Variable("x", ["a", "b", "c"])
    model = fp.FactoredPOMDP(
        states=[x],
        actions=[fp.Variable("go", ["on"])],
        observations=[],
        transition={"x": fp.table("x", "x.next", values=[[0.2, 0.0, 0.8], [0.0, 1.0, 0.0], [0.5, 0.5, 0.0]])},
        observation={},
        reward=fp.table("x", values=[0.0, 1.0, 2.0]),
        initial={"x": "a"},
        discount=0.9,
    )
    worlds = Worlds(model)
    assert worlds.numbers == 1
    numbers = np.array([[0.0, 0.1999, 0.2001, 0.9999, 0.5, 0.4999, 0.5001]])
    states = {"x": np.array([0, 0, 0, 0, 1, 2, 2])}
    after, _ = worlds.step(states, {"go": np.zeros(7, dtype=int)}, numbers)
    assert after["x"].tolist() == [0, 0, 2, 2, 1, 0, 1]


@pytest.mark.example
def test_the_first_cause_that_acts_shows_the_value() -> None:
    """Two eyes, each seeing with 0.5: the first number decides for one, the second for the other, the third what."""
    x, eye = fp.Variable("x", ["here"]), fp.Variable("eye", ["shut", "open"])
    shown = fp.Variable("shown", ["nothing", "left", "right"])
    sharp, dull = sparse.csr_array([[0.0, 1.0, 0.0]]), sparse.csr_array([[0.0, 0.25, 0.75]])
    causes = [fp.Cause(eye.next, np.array([[0.0], [0.5]]), sharp), fp.Cause(None, np.array([[0.5]]), dull)]
    model = fp.FactoredPOMDP(
        states=[x, eye],
        actions=[eye.renamed("turn")],
        observations=[shown],
        transition={"x": {"here": 1.0}, "eye": lambda turn: turn},
        observation={"shown": fp.NoisyOr([x.next], shown, "nothing", causes)},
        reward=fp.table("shown", values=[0.0, 1.0, 1.0]),
        initial={"x": "here", "eye": "shut"},
        discount=0.9,
    )
    worlds = Worlds(model)
    luck = {"shut": [0.1, 0.4, 0.2], "both": [0.4, 0.4, 0.9], "dull": [0.6, 0.4, 0.9], "none": [0.6, 0.6, 0.9]}
    numbers = np.array(list(luck.values())).T
    rest = np.zeros((worlds.numbers - 3, 4))
    states = {"x": np.zeros(4, dtype=int), "eye": np.zeros(4, dtype=int)}
    _, seen = worlds.step(states, {"turn": np.array([0, 1, 1, 1])}, np.concatenate([rest, numbers]))
    assert [shown.values[place] for place in seen["shown"]] == ["left", "left", "right", "nothing"]


@pytest.mark.example
def test_states_are_drawn_from_the_belief() -> None:
    model = fp.domain("machine-repair", machines=2)
    belief = fp.initial_belief(model).with_arrays([np.array([[0.5, 0.0], [0.5, 0.0], [0.0, 1.0]])])
    drawn = Worlds(model).drawn(belief, 2000, np.random.default_rng(1))
    first, second = (drawn[names[0]] for names in belief.blocks)
    assert set(second.tolist()) == {2}
    assert np.bincount(first, minlength=3)[:2] == pytest.approx([1000, 1000], abs=5 * 0.5 * np.sqrt(2000))
    assert set(first.tolist()) == {0, 1}
