"""The exponential solver against plain loops over everything."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.domains.machine_repair import machine_repair
from factored_pomdp.domains.tiger import tiger
from solvers import JointMyopic
from tests.belief_steps import joint_of
from tests.plain import PlainModel
from tests.small_cameras import camera_model
from tests.strategies import random_beliefs, random_models


@pytest.mark.property
@settings(max_examples=8)
@given(data=st.data(), sparse=st.booleans())
def test_values_are_what_plain_loops_give(data: st.DataObject, sparse: bool) -> None:
    model = data.draw(random_models(most_states=3))
    plain = PlainModel(model)
    solver = JointMyopic(model, sparse=sparse)
    belief = joint_of(model, data.draw(random_beliefs(model)))
    masses = belief.table.array_over(model.states).ravel().tolist()
    for action in plain.actions:
        assert solver.value(belief, action) == pytest.approx(plain.value(masses, action), abs=1e-9)


@pytest.mark.example
def test_tiger() -> None:
    solver = JointMyopic(tiger())
    first = solver.decide(solver.start())
    assert (first.action, first.value) == ({"act": "listen"}, -1.0)
    heard = solver.start().predict("listen").condition("left").predict("listen").condition("left")
    assert heard.marginal("tiger").array[0] == pytest.approx(0.85**2 / (0.85**2 + 0.15**2))
    third = heard.predict("listen").condition("left")
    sure = 0.85**3 / (0.85**3 + 0.15**3)
    decision = solver.decide(third)
    assert decision.action == {"act": "open-right"}
    assert decision.value == pytest.approx(10 * sure - 100 * (1 - sure))
    assert decision.method == "enumeration of 3 joint actions, joint belief"
    assert decision.proved


@pytest.mark.example
def test_only_actions_that_are_legal_wherever_the_belief_has_mass() -> None:
    model = fp.FactoredPOMDP(
        states=[fp.Variable("gate", ["open", "shut"])],
        actions=[fp.Variable("act", ["pass", "wait"])],
        observations=[],
        transition={"gate": lambda gate: gate},
        observation={},
        reward={"r": lambda act: float(act == "pass")},
        initial={"gate": {"open": 0.5, "shut": 0.5}},
        legal={"act": lambda gate, act: gate == "open" or act == "wait"},
    )
    solver = JointMyopic(model)
    assert solver.decide(solver.start()).action == {"act": "wait"}
    opened = solver.start().condition(known={"gate": "open"})
    assert solver.decide(opened).action == {"act": "pass"}


@pytest.mark.example
def test_among_equals_the_preferred_then_the_first() -> None:
    solver = JointMyopic(machine_repair(2))
    flat = fp.FactoredPOMDP(
        states=[fp.Variable("x", [0, 1])],
        actions=[fp.Variable("a", [0, 1]), fp.Variable("b", [0, 1])],
        observations=[],
        transition={"x": lambda x: x},
        observation={},
        reward={},
        initial={"x": 0},
    )
    level = JointMyopic(flat)
    assert level.decide(level.start()).action == {"a": 0, "b": 0}
    assert level.decide(level.start(), prefer={"a": 1, "b": 1}).action == {"a": 1, "b": 1}
    assert solver.decide(solver.start(), prefer={"machine1.hand": "repair"}).action["machine1.hand"] == "run"


@pytest.mark.example
def test_too_large_a_model_is_refused_with_its_sizes_before_anything_is_made() -> None:
    cells = 200
    views = [{"left": frozenset({0}), "right": frozenset({1})}]
    model = camera_model([np.eye(cells)] * 3, views, [np.full(cells, 1 / cells)] * 3)
    ability = JointMyopic.can_solve(model)
    assert not ability
    sizes = "16,000,000 joint states, 2 joint actions, 8,120,601 joint observations"
    assert ability.because == f"{sizes}: more than 5,000,000 joint states to hold"
    assert ability.estimate == "2.6e+14 operations a decision, 128,000,000 bytes a belief"
    with pytest.raises(fp.TooLarge, match="16,000,000 joint states"):
        JointMyopic(model)
    small = JointMyopic.can_solve(machine_repair(2))
    assert small
    assert small.because == "9 joint states, 4 joint actions, 9 joint observations"
