"""Values where episodes end: both one-step solvers against the expansion, and whether being told of the end matters."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.beliefs.comparison import joint_of, random_product_belief
from solvers import DecomposedMyopic, JointMyopic
from solvers.belief_tree import tree_values
from solvers.block_bounds import block_bound
from tests.ending_models import ending_models


@pytest.mark.property
@settings(max_examples=12)
@given(ending_models(), st.integers(0, 2**32 - 1), st.booleans())
def test_values_of_both_solvers_are_the_expansions(model: fp.FactoredPOMDP, seed: int, sparse: bool) -> None:
    rng, flat = np.random.default_rng(seed), fp.joint(model)
    state = fp.Simulation(model).start(rng)
    if model.is_terminal(state):
        return
    product = random_product_belief(model, state, rng)
    joint = joint_of(product, sparse)
    literal, decomposed = JointMyopic(model, sparse=sparse), DecomposedMyopic(model)
    expected = flat.reward @ _array(model, joint)
    for action, reward in zip(flat.actions, expected, strict=True):
        assert literal.value(joint, action) == pytest.approx(reward, abs=1e-9)
        assert decomposed.value(product, action) == pytest.approx(reward, abs=1e-9)
    best = max(value for _, value in literal.values(joint))
    assert literal.decide(joint).value == pytest.approx(best, abs=1e-9)
    assert decomposed.decide(product).value == pytest.approx(best, abs=1e-9)


@pytest.mark.property
@settings(max_examples=12)
@given(ending_models(), st.integers(0, 2**32 - 1))
def test_mass_in_terminal_states_is_left_out_of_a_decision(model: fp.FactoredPOMDP, seed: int) -> None:
    rng, flat = np.random.default_rng(seed), fp.joint(model)
    moved, later = rng.integers(len(flat.actions), size=2)
    predicted = flat.initial @ flat.transition[moved]
    running = predicted[~flat.terminal].sum()
    if not running > 1e-6:
        return
    belief = fp.JointBelief.initial(model).predict(flat.actions[moved])
    value = JointMyopic(model).value(belief, flat.actions[later])
    assert running * value == pytest.approx(float(flat.reward[later] @ predicted), abs=1e-9)


@pytest.mark.example
def test_product_belief_with_mass_in_a_terminal_state() -> None:
    bit, other, act = fp.Variable("bit", [0, 1]), fp.Variable("other", [0, 1]), fp.Variable("act", ["stay", "flip"])
    model = fp.FactoredPOMDP(
        states=[bit, other],
        actions=[act],
        observations=[],
        transition={
            "bit": lambda bit, act: bit if act == "stay" else 1 - bit,
            "other": lambda other: {other: 0.5, 1 - other: 0.5},
        },
        observation={},
        reward={"bit": lambda bit, act: 3.0 * bit, "other": lambda other: 1.0 * other, "cost": -0.5},
        initial={"bit": {0: 0.25, 1: 0.75}, "other": {0: 0.25, 1: 0.75}},
        terminal=fp.table("bit", values=[0, 1]),
    )
    uncertain = fp.initial_belief(model).with_arrays(
        [np.full(array.shape, 0.5) for array in fp.initial_belief(model).arrays]
    )
    assert DecomposedMyopic(model).value(uncertain, "stay") == pytest.approx(0.5 - 0.5)
    assert DecomposedMyopic(model).value(fp.initial_belief(model), "flip") == pytest.approx(0.75 - 0.5)


@pytest.mark.example
def test_upper_bound_by_blocks_where_ending_saves_costs() -> None:
    names = ["one", "two"]
    model = fp.FactoredPOMDP(
        states=[fp.Variable(name, ["goes", "stands"]) for name in names],
        actions=[fp.Variable("act", ["wait"])],
        observations=[],
        transition={name: fp.table(name, values=lambda x: {"stands": 1.0}) for name in names},
        observation={},
        reward={name: fp.table(name, values=lambda x: -1.0) for name in names},
        initial=dict.fromkeys(names, "goes"),
        discount=0.9,
        terminal=fp.table("one", values=lambda x: x == "stands"),
    )
    # the first step costs 2 and is the last one; no end in sight, a block would think that it pays 10
    assert float(tree_values(model, 3).max()) == pytest.approx(-2.0)
    bound, _ = block_bound(model, None)
    assert -2.0 <= bound <= 0.0


@pytest.mark.property
@pytest.mark.slow
@settings(max_examples=8)
@given(ending_models(most_states=2))
def test_being_told_of_the_end_changes_no_value(model: fp.FactoredPOMDP) -> None:
    flat = fp.joint(model)
    chance = float(flat.initial[~flat.terminal].sum())
    untold = tree_values(model, 2).max()
    start = fp.JointBelief.initial(model)
    assert chance * _told(model, start, 2) == pytest.approx(float(untold), abs=1e-9)


def _told(model: fp.FactoredPOMDP, belief: fp.JointBelief, horizon: int) -> float:
    """``max_a r(b, a) + γ Σ P(z, read, goes on | b, a) V(b')`` over conditioned beliefs."""
    worth = []
    for action, value in JointMyopic(model).values(belief):
        predicted = belief.predict(action)
        for seen, read in _answers(model) if horizon > 1 else ():
            chance = _chance(model, predicted, seen, read)
            if chance > 1e-12:
                value += model.discount * chance * _told(model, predicted.condition(seen, known=read), horizon - 1)
        worth.append(value)
    return max(worth)


def _answers(model: fp.FactoredPOMDP) -> list[tuple[dict[str, Any], dict[str, Any]]]:
    known = [v for v in model.states if v.name in fp.decompose(model, counterexamples=False).known]
    read = [variable for variable in known if variable.name in model.declared_known]

    def assignments(variables: Any) -> list[dict[str, Any]]:
        names = [variable.name for variable in variables]
        return [dict(zip(names, v, strict=True)) for v in itertools.product(*(x.values for x in variables))]

    return list(itertools.product(assignments(model.observations), assignments(read)))


def _chance(model: fp.FactoredPOMDP, predicted: fp.JointBelief, seen: dict[str, Any], read: dict[str, Any]) -> float:
    """``P(seen, read, the episode goes on)``."""
    weights = _array(model, predicted).reshape([v.size for v in model.states]).copy()
    weights *= predicted.likelihood(seen).array_over(model.states)
    weights[np.broadcast_to(model.terminal.array_over(model.states) != 0, weights.shape)] = 0.0
    for axis, variable in enumerate(model.states):
        if variable.name in read:
            weights = weights.take([variable.index(read[variable.name])], axis=axis)
    return float(weights.sum())


def _array(model: fp.FactoredPOMDP, belief: fp.JointBelief) -> np.ndarray:
    return np.broadcast_to(belief.table.array_over(model.states), [v.size for v in model.states]).ravel()
