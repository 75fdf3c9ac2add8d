"""Beliefs of episodes that go on, against the expansion, where terminal states are absorbing and nobody is told."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.beliefs.comparison import random_product_belief
from factored_pomdp.episodes import read_back
from factored_pomdp.expansion import Joint
from solvers.flat import flatten
from solvers.flat_belief import FlatBelief
from tests.belief_steps import multiplied
from tests.ending_models import ending_models, with_end
from tests.strategies import random_models

BIT = [0, 1]


def two(terminal: Any, **changes: Any) -> fp.FactoredPOMDP:
    """Bits that flip now and then and are seen dimly; each earns what it is."""
    names = ["a", "b"]
    given: dict[str, Any] = {
        "transition": {n: fp.table(n, values=lambda x: {x: 0.9, 1 - x: 0.1}) for n in names},
        "observation": {f"see.{n}": fp.table(f"{n}.next", values=lambda x: {x: 0.8, 1 - x: 0.2}) for n in names},
        "initial": {name: {0: 0.75, 1: 0.25} for name in names},
    }
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, BIT) for name in names],
        actions=[fp.Variable("act", ["only"])],
        observations=[fp.Variable(f"see.{name}", BIT) for name in names],
        reward={name: fp.table(f"{name}.next", values=float) for name in names},
        discount=0.9,
        terminal=terminal,
        **(given | changes),
    )


@pytest.mark.example
def test_posterior_of_a_bit_that_has_not_ended_the_episode() -> None:
    belief = fp.initial_belief(two(lambda a: a == 1))
    assert belief.marginal("a").tolist() == [1.0, 0.0]
    assert belief.marginal("b").tolist() == [0.75, 0.25]
    predicted = belief.predict("only")
    assert predicted.marginal("a") == pytest.approx([0.9, 0.1])
    after = predicted.condition({"see.a": 1, "see.b": 1})
    assert after.marginal("a").tolist() == [1.0, 0.0]
    mass = 0.2 * (0.75 * 0.9 + 0.25 * 0.1), 0.8 * (0.75 * 0.1 + 0.25 * 0.9)
    assert after.marginal("b") == pytest.approx([mass[0] / sum(mass), mass[1] / sum(mass)])


@pytest.mark.example
def test_belief_without_mass_in_terminal_states_is_left_as_it_is() -> None:
    for start in (fp.initial_belief(two(lambda a, b: a or b)), fp.JointBelief.initial(two(lambda a, b: a and b))):
        assert start.running() is start
        predicted = start.predict("only")
        assert predicted.running() is not predicted
    plain = fp.initial_belief(two(None)).predict("only")
    assert plain.running() is plain


@pytest.mark.example
def test_an_episode_that_is_known_to_be_over_is_refused() -> None:
    lamp = fp.FactoredPOMDP(
        states=[fp.Variable("lamp", ["on", "off"])],
        actions=[fp.Variable("turn", ["on", "off"])],
        observations=[],
        transition={"lamp": lambda turn: turn},
        observation={},
        reward=1.0,
        initial={"lamp": "on"},
        terminal={"off": 1},
    )
    flat = FlatBelief.initial(flatten(lamp))
    for belief in (fp.initial_belief(lamp), fp.JointBelief.initial(lamp), flat):
        again = belief.predict("on").condition({})
        with pytest.raises(fp.ImpossibleObservation, match=r"episode goes on.*probability zero for block \[lamp\]"):
            again.predict("off").condition({})
    certain = two(lambda a: a == 1, initial={"a": {1: 1.0}, "b": {0: 1.0}})
    with pytest.raises(fp.ImpossibleObservation, match="episode goes on"):
        fp.JointBelief.initial(certain)


@pytest.mark.property
@settings(max_examples=18)
@given(ending_models(), st.integers(0, 2**32 - 1))
def test_all_beliefs_are_the_running_part_of_the_expansions(model: fp.FactoredPOMDP, seed: int) -> None:
    rng, world, flat = np.random.default_rng(seed), fp.Simulation(model), fp.joint(model)
    state, untold = world.start(rng), flat.initial
    if model.is_terminal(state):
        return
    beliefs: list[Any] = [fp.initial_belief(model), fp.JointBelief.initial(model, sparse=bool(seed % 2))]
    beliefs += [] if model.legal else [FlatBelief.initial(flatten(model))]
    for _ in range(4):
        for belief in beliefs:
            assert _array(model, belief) == pytest.approx(_going_on(flat, untold), abs=1e-9)
        action = _legal_action(model, state, rng)
        state, seen, _ = world.step(state, action, rng)
        if model.is_terminal(state):
            return
        untold = _untold(model, flat, untold, action, seen, read_back(model, state))
        beliefs = [b.predict(action).condition(seen, known=read_back(model, state)) for b in beliefs]


@pytest.mark.property
@settings(max_examples=12)
@given(ending_models(), st.integers(0, 2**32 - 1))
def test_two_steps_without_a_look_are_those_of_the_expansion(model: fp.FactoredPOMDP, seed: int) -> None:
    rng, flat = np.random.default_rng(seed), fp.joint(model)
    first, second = rng.integers(len(flat.actions), size=2)
    moved = flat.initial @ flat.transition[first] @ flat.transition[second]
    if not moved[~flat.terminal].sum() > 1e-9:
        return
    belief = fp.JointBelief.initial(model).predict(flat.actions[first]).predict(flat.actions[second])
    assert _array(model, belief.running()) == pytest.approx(_going_on(flat, moved), abs=1e-9)


@pytest.mark.property
@settings(max_examples=12)
@given(ending_models(), st.integers(0, 2**32 - 1))
def test_random_beliefs_hold_no_mass_in_terminal_states(model: fp.FactoredPOMDP, seed: int) -> None:
    rng, flat = np.random.default_rng(seed), fp.joint(model)
    state = fp.Simulation(model).start(rng)
    if not model.is_terminal(state):
        belief = multiplied(model, random_product_belief(model, state, rng)).ravel()
        assert belief.sum() == pytest.approx(1.0)
        assert belief[flat.terminal].sum() == 0.0


@pytest.mark.property
@settings(max_examples=8)
@given(random_models(3), st.integers(0, 2**32 - 1))
def test_terminal_states_that_are_none_change_nothing(model: fp.FactoredPOMDP, seed: int) -> None:
    same = with_end(model, fp.DenseFactor((), 0.0))
    rng, world = np.random.default_rng(seed), fp.Simulation(model)
    state = world.start(rng)
    action = _legal_action(model, state, rng)
    state, seen, _ = world.step(state, action, rng)
    one, other = (
        fp.initial_belief(m).predict(action).condition(seen, known=read_back(m, state)) for m in (model, same)
    )
    assert multiplied(model, one).tolist() == multiplied(same, other).tolist()


def _going_on(flat: Joint, untold: np.ndarray) -> np.ndarray:
    running = np.where(flat.terminal, 0.0, untold)
    return running / running.sum()


def _array(model: fp.FactoredPOMDP, belief: fp.ProductBelief | fp.JointBelief | FlatBelief) -> np.ndarray:
    """Over joint states, row-major."""
    if isinstance(belief, FlatBelief):
        return belief.vector[belief.flat.rank]
    if isinstance(belief, fp.ProductBelief):
        return multiplied(model, belief).ravel()
    return np.broadcast_to(belief.table.array_over(model.states), [v.size for v in model.states]).ravel()


def _untold(
    model: fp.FactoredPOMDP,
    flat: Joint,
    belief: np.ndarray,
    action: Mapping[str, Any],
    seen: Mapping[str, Any],
    read: Mapping[str, Any],
) -> np.ndarray:
    """One step of Bayes' rule on the expansion, not normalised."""
    number = flat.actions.index(dict(action))
    after = (belief @ flat.transition[number]) * flat.observation[number].toarray()[:, flat.observations.index(seen)]
    indexes = np.indices([v.size for v in model.states]).reshape(len(model.states), -1)
    for name, value in read.items():
        axis = [v.name for v in model.states].index(name)
        after = after * (indexes[axis] == model.variable(name).index(value))
    return after


def _legal_action(model: fp.FactoredPOMDP, state: Mapping[str, Any], rng: np.random.Generator) -> dict[str, Any]:
    while True:
        action = {v.name: v.values[int(rng.integers(v.size))] for v in model.actions}
        if model.is_legal(action, state):
            return action
