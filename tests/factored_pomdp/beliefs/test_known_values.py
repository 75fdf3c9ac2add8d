"""Values that are read back: instead of the planned ones, as evidence, not at all, or shown by an observation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import sparse

import factored_pomdp as fp
from tests.belief_steps import gap
from tests.lamp import lamp_model

BIT = [0, 1]
FAIR = {0: 0.5, 1: 0.5}


@pytest.mark.example
def test_a_read_back_value_counts_not_the_planned_one() -> None:
    model = lamp_model()
    for belief in (fp.initial_belief(model), fp.JointBelief.initial(model)):
        planned = belief.predict(1)
        lit = planned.condition({"see.x": 1})
        off = planned.condition({"see.x": 1}, known={"lamp": 0})
        assert [_mass(lit, "x"), _mass(off, "x")] == [1.0, 0.5]  # without light the reading is worth nothing
        assert _mass(off.predict(1), "y") == 0.5
    off = fp.initial_belief(model).predict(1).condition({"see.y": 1}, known={"lamp": 0})
    assert off.known == {"lamp": 0}
    np.testing.assert_allclose(off.predict(1).marginal("y"), [0.25, 0.75])  # y stays where the lamp was off


def _mass(belief: fp.ProductBelief | fp.JointBelief, name: str) -> float:
    marginal = belief.marginal(name)
    return float((marginal if isinstance(belief, fp.ProductBelief) else marginal.array)[1])


@pytest.mark.example
def test_an_unread_cause_is_absent() -> None:
    """A camera that did not answer has not looked: silence then says nothing."""
    place, seen = fp.Variable("place", ["near", "far"]), fp.Variable("seen", ["near", "far", "nothing"])
    cameras = [fp.Variable(f"camera{k}", ["in", "out"]) for k in (1, 2)]
    moves = [fp.Variable(f"move{k}", ["in", "out"]) for k in (1, 2)]
    exact = sparse.csr_array(np.array([[1.0, 0, 0], [0, 1.0, 0]]))
    looks = np.array([[0.8, 0.0], [0.0, 0.6]])
    model = fp.FactoredPOMDP(
        states=[place, *cameras],
        actions=moves,
        observations=[seen],
        transition={
            "place": lambda place: {"near": 0.5, "far": 0.5},
            **{c.name: fp.table(m.name, values=lambda m: m) for c, m in zip(cameras, moves, strict=True)},
        },
        observation={
            "seen": fp.NoisyOr([place.next], seen, "nothing", [fp.Cause(c.next, looks, exact) for c in cameras])
        },
        reward={},
        initial={"place": "near", "camera1": "in", "camera2": "in"},
    )
    predicted = fp.initial_belief(model).predict({"move1": "in", "move2": "in"})
    both = predicted.condition("nothing")
    np.testing.assert_allclose(both.marginal("place"), [0.04 / 1.04, 1 / 1.04])
    one = predicted.condition("nothing", known={"camera1": None})
    np.testing.assert_allclose(one.marginal("place"), [0.2 / 1.2, 1 / 1.2])
    none = predicted.condition("nothing", known={"camera1": None, "camera2": None})
    np.testing.assert_allclose(none.marginal("place"), [0.5, 0.5])
    assert none.known == {"camera1": None, "camera2": None}
    back = none.predict({"move1": "out", "move2": "in"}).condition("far")
    assert back.known == {"camera1": "out", "camera2": "in"}
    with pytest.raises(fp.ImpossibleObservation):
        none.predict({"move1": "in", "move2": "in"}).condition("far")
    joint = fp.JointBelief.initial(model).predict({"move1": "in", "move2": "in"})
    unread = joint.condition("nothing", known={"camera1": None})
    np.testing.assert_allclose(unread.marginal("place").array, [0.2 / 1.2, 1 / 1.2])


@pytest.mark.example
def test_only_a_noisy_or_can_do_without_a_parent() -> None:
    with pytest.raises(ValueError, match=r"lamp\.next=None: only a noisy-or can do without one of its parents"):
        fp.initial_belief(lamp_model()).predict(1).condition({"see.x": 1}, known={"lamp": None})


@pytest.mark.example
def test_names_and_values_are_checked() -> None:
    belief = fp.initial_belief(lamp_model()).predict(1)
    with pytest.raises(ValueError, match=r"no state variable 'lam' \(did you mean 'lamp'\?\)"):
        belief.condition({}, known={"lam": 1})
    with pytest.raises(ValueError, match="'lamp' has no value 2"):
        belief.condition({}, known={"lamp": 2})
    with pytest.raises(ValueError, match="'y' has no value 2"):
        belief.condition({}, known={"y": 2})
    with pytest.raises(ValueError, match=r"no observation variable 'lamp'"):
        belief.condition({"lamp": 1})
    with pytest.raises(ValueError, match=r"'see\.x' has no value 7"):
        belief.condition({"see.x": 7})
    with pytest.raises(ValueError, match=r"no hidden variable 'lamp' \(there are: x, y\)"):
        belief.marginal("lamp")


@pytest.mark.example
def test_a_hidden_variable_that_is_read_back_is_evidence_about_its_block() -> None:
    model = lamp_model(initial={"x": FAIR, "y": lambda x: {x: 0.75, 1 - x: 0.25}, "lamp": 0})
    belief, joint = fp.initial_belief(model), fp.JointBelief.initial(model)
    told = belief.predict(0).condition({"see.x": 1}, known={"y": 1})
    assert told.block("x").names in (("x", "y"), ("y", "x"))
    np.testing.assert_allclose(told.marginal("y"), [0.0, 1.0])
    np.testing.assert_allclose(told.marginal("x"), [0.375, 0.625])  # 0.75² + 0.25² = 0.625 beside its complement
    assert gap(model, told, joint.predict(0).condition({"see.x": 1}, known={"y": 1})) <= 1e-12
    with pytest.raises(fp.ImpossibleObservation, match=r"\{'y': 0\} has probability zero for block \[x, y\]"):
        told.condition(known={"y": 0})


def alarm(**changes: object) -> fp.FactoredPOMDP:
    """A smouldering fire moves an alarm that is read after every step."""
    return fp.FactoredPOMDP(
        states=[fp.Variable("fire", BIT), fp.Variable("alarm", BIT)],
        actions=[fp.Variable("wait", ["on"])],
        observations=[fp.Variable("smell", BIT)],
        transition={
            "fire": lambda fire: {1: 1.0} if fire else {0: 0.5, 1: 0.5},
            "alarm": lambda fire, alarm: {1: 0.75, 0: 0.25} if fire and not alarm else {1: 0.25, 0: 0.75},
        },
        observation={"smell": lambda fire_next: {1: 0.5, 0: 0.5} if fire_next else 0},
        reward={},
        initial={"fire": FAIR, "alarm": 0},
        known=["alarm"],
        **changes,
    )


@pytest.mark.example
def test_a_known_variable_that_a_hidden_one_moves_tells_of_the_step_before() -> None:
    model = alarm()
    belief = fp.initial_belief(model)
    assert belief.known == {"alarm": 0}
    rung = belief.predict("on").condition({"smell": 0}, known={"alarm": 1})
    # fire before: 3/4, hence after: 7/8, of which half is not smelt
    np.testing.assert_allclose(rung.marginal("fire"), [2 / 9, 7 / 9])
    joint = fp.JointBelief.initial(model).predict("on").condition({"smell": 0}, known={"alarm": 1})
    assert gap(model, rung, joint) <= 1e-12
    twice = rung.predict("on").condition(known={"alarm": 0})
    assert gap(model, twice, joint.predict("on").condition(known={"alarm": 0})) <= 1e-12


@pytest.mark.example
def test_what_was_read_is_weighed_once() -> None:
    predicted = fp.initial_belief(alarm()).predict("on")
    together = predicted.condition({"smell": 0}, known={"alarm": 1})
    later = predicted.condition(known={"alarm": 1}).condition({"smell": 0})
    again = later.condition(known={"alarm": 1})
    np.testing.assert_allclose(later.marginal("fire"), together.marginal("fire"))
    np.testing.assert_allclose(again.marginal("fire"), together.marginal("fire"))
    with pytest.raises(ValueError, match=r"read in the first condition\(\) after predict\(\)"):
        predicted.condition({"smell": 0}).condition(known={"alarm": 1})


@pytest.mark.example
def test_an_observation_shows_a_known_variable_where_nothing_else_is_read() -> None:
    model = fp.FactoredPOMDP(
        states=[fp.Variable("gear", [1, 2, 3]), fp.Variable("wear", BIT)],
        actions=[fp.Variable("drive", ["on"])],
        observations=[fp.Variable("dial", "abc"), fp.Variable("noise", BIT)],
        transition={
            "gear": lambda gear: {1: 0.25, 2: 0.5, 3: 0.25},
            "wear": lambda wear, gear: {1: 1.0} if wear else {0: 1 - gear / 4, 1: gear / 4},
        },
        observation={
            "dial": fp.table("gear.next", "wear.next", values=lambda gear, wear: "abc"[gear - 1]),
            "noise": lambda wear_next, gear_next: {1: 0.25 * gear_next, 0: 1 - 0.25 * gear_next} if wear_next else 0,
        },
        reward={},
        initial={"gear": 2, "wear": {0: 0.5, 1: 0.5}},
    )
    belief, joint = fp.initial_belief(model), fp.JointBelief.initial(model)
    assert belief.known == {"gear": 2}
    for dial, noise, gear in (("c", 1, 3), ("a", 0, 1)):
        belief = belief.predict("on").condition({"dial": dial, "noise": noise})
        joint = joint.predict("on").condition({"dial": dial, "noise": noise})
        assert belief.known == {"gear": gear}
        assert gap(model, belief, joint) <= 1e-12
    blind = belief.predict("on")
    assert blind.known == {"gear": None}
    with pytest.raises(ValueError, match="None"):
        blind.predict("on")


@pytest.mark.example
def test_the_joint_belief_takes_a_possible_value_as_evidence_and_refuses_an_impossible_chance() -> None:
    joint = fp.JointBelief.initial(alarm()).predict("on")
    fire = joint.condition(known={"alarm": 1}).marginal("fire").array
    np.testing.assert_allclose(fire, [1 / 8, 7 / 8])
    model = fp.FactoredPOMDP(
        states=[fp.Variable("die", [1, 2, 3])],
        actions=[fp.Variable("throw", ["on"])],
        observations=[],
        transition={"die": lambda: {1: 0.5, 2: 0.5}},
        observation={},
        reward={},
        initial={"die": 1},
        known=["die"],
    )
    with pytest.raises(fp.ImpossibleObservation, match="'die': 3"):
        fp.JointBelief.initial(model).predict("on").condition(known={"die": 3})


@pytest.mark.example
@pytest.mark.parametrize("shows", [np.eye(2), [[1, 0], [0.5, 0.5]]])
def test_what_a_known_variable_cannot_show_is_impossible(shows: Any) -> None:
    lamp, coin = fp.Variable("lamp", ["off", "on"]), fp.Variable("coin", ["heads", "tails"])
    light, wait = fp.Variable("light", ["dark", "bright"]), fp.Variable("do", ["wait"])
    model = fp.FactoredPOMDP(
        states=[lamp, coin],
        actions=[wait],
        observations=[light],
        transition={"lamp": lambda lamp: lamp, "coin": fp.table("coin.next", values=[0.5, 0.5])},
        observation={"light": fp.table("lamp.next", "light", values=shows)},
        reward=fp.table("coin.next", values=[1.0, 0.0]),
        initial={"lamp": "off", "coin": {"heads": 0.5, "tails": 0.5}},
    )
    belief = fp.initial_belief(model)
    assert belief.known == {"lamp": "off"}
    predicted = belief.predict("wait")
    assert predicted.condition({"light": "dark"}).known == {"lamp": "off"}
    with pytest.raises(fp.ImpossibleObservation, match=r"'bright'\} has probability zero for block \[lamp\]"):
        predicted.condition({"light": "bright"})
