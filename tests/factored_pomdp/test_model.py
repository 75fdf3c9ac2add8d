"""Models: made in full or not at all, with every fault said at once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp

SKY = fp.Variable("sky", ["sun", "rain"])
HAND = fp.Variable("hand", ["dry", "wet"])
ACT = fp.Variable("act", ["in", "out"])
SEEN = fp.Variable("seen", ["bright", "dark"])


def parts(**changes: Any) -> dict[str, Any]:
    """A well-formed model's parts, some of them changed."""
    given: dict[str, Any] = {
        "states": [SKY, HAND],
        "actions": [ACT],
        "observations": [SEEN],
        "transition": {
            "sky": fp.table("sky", "sky.next", values=[[0.8, 0.2], [0.4, 0.6]]),
            "hand": lambda sky_next, act: "wet" if (sky_next, act) == ("rain", "out") else "dry",
        },
        "observation": {"seen": lambda sky_next: {"bright": 0.9, "dark": 0.1} if sky_next == "sun" else {"dark": 1.0}},
        "reward": {"out": lambda act: float(act == "out"), "wet": lambda hand_next: -3.0 * (hand_next == "wet")},
        "initial": {"sky": {"sun": 0.5, "rain": 0.5}, "hand": "dry"},
        "discount": 0.9,
    }
    return given | changes


def faults(**changes: Any) -> list[str]:
    with pytest.raises(fp.ModelError) as raised:
        fp.FactoredPOMDP(**parts(**changes))
    return [str(fault) for fault in raised.value.faults]


@pytest.mark.example
def test_a_model_knows_its_parts() -> None:
    model = fp.FactoredPOMDP(**parts())
    assert (model.joint_states, model.joint_actions, model.joint_observations) == (4, 2, 2)
    assert list(model.variables) == ["sky", "hand", "sky.next", "hand.next", "act", "seen"]
    assert model.variable("sky.next") == SKY.next
    assert model.notes == ()
    assert isinstance(model.transition["hand"], fp.DeterministicFactor)
    with pytest.raises(ValueError, match=r"no variable 'skye' in model \(did you mean 'sky'\?\)"):
        model.variable("skye")


@pytest.mark.example
def test_everything_that_is_wrong_is_said_at_once() -> None:
    everything_wrong: dict[str, Any] = dict(
        states=[SKY, HAND, fp.Variable("lost", [0, 1]), fp.Variable("ghost.next", [0])],
        observations=[SEEN, fp.Variable("sky", [1])],
        transition={
            "sky": fp.table("sky", "sky.next", values=[[0.8, 0.3], [-0.4, 1.4]]),
            "hand": lambda moon: "dry",
            "lost": {0: 0.5, 1: float("nan")},
            "cloud": {"a": 1.0},
        },
        observation={"seen": fp.table("sky.next", "seen", values=np.ones((2, 3)))},
        reward={"out": lambda act: 1.0, "far": lambda venus: 1.0},
        initial={"sky": "sun", "hand": "dri"},
        known=["sea"],
        discount=float("nan"),
    )
    found = faults(**everything_wrong)
    said = "\n".join(found)
    for expected in [
        "variable ghost.next: found the ending '.next'; expected a name without it",
        "variable sky: found the name of two: state and observation; expected a name used once",
        "known: found the unknown state 'sea'; expected a state variable",
        "transition of sky.next at sky=sun: found probabilities that sum to 1.1; expected sum 1",
        "transition of sky.next at sky=rain, sky.next=sun: found -0.4; expected a probability in [0, 1]",
        "transition of hand.next: found a function of the unknown 'moon'",
        "transition of lost.next at lost.next=1: found nan; expected a probability in [0, 1]",
        "transition['cloud']: found an unknown variable",
        "observation of seen: found an array of shape (2, 3); expected shape (2, 2)",
        "observation of sky: found no distribution; expected one for every variable",
        "reward far: found a function of the unknown 'venus'",
        "initial of hand: found 'dri'",
        "initial of lost: found no distribution",
        "discount: found nan; expected a number in [0, 1]",
    ]:
        assert expected in said
    with pytest.raises(fp.ModelError, match=rf"^{len(found)} faults in the model\n"):
        fp.FactoredPOMDP(**parts(**everything_wrong))


@pytest.mark.example
@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"states": []}, "states: found none; expected at least one variable"),
        ({"actions": []}, "actions: found none; expected at least one variable"),
        ({"actions": [ACT, SKY]}, "variable sky: found the name of two: state and action; expected a name used once"),
        ({"groups": [["sky", "sea"]]}, "group ('sky', 'sea'): found the unknown state 'sea'"),
        ({"known": ["sky"]}, "known sky: found an uncertain start; expected a certain initial value"),
        ({"discount": 1.5}, "discount: found 1.5; expected a number in [0, 1]"),
        ({"reward": {"past": lambda seen_next: 1.0}}, "reward past: found a function of the unknown 'seen_next'"),
        (
            {"observation": {"seen": lambda sky: "dark"}},
            "of the unknown 'sky'; expected parameters named as variables (did you mean 'sky_next'?)",
        ),
        (
            {"legal": {"akt": lambda hand: True}},
            "legal['akt']: found an unknown action; expected an action (did you mean 'act'?)",
        ),
        (
            {"legal": {"act": lambda hand, act: hand == "dry"}},
            "legal act: found a state without any legal action; expected at least one",
        ),
        (
            {"legal": {"act": lambda hand: True}},
            "legal act: found a function that does not read act; expected act in its scope",
        ),
    ],
)
def test_single_faults(changes: dict[str, Any], expected: str) -> None:
    assert any(expected in fault for fault in faults(**changes))


@pytest.mark.example
def test_an_observation_reads_no_other_observation() -> None:
    echo = fp.Variable("echo", ["bright", "dark"])
    observation = parts()["observation"] | {"echo": lambda seen: seen}
    assert faults(observations=[SEEN, echo], observation=observation) == [
        "observation of echo: found a function of the unknown 'seen'; expected parameters named as variables "
        "(there are: sky_next, hand_next, act, echo)"
    ]


@pytest.mark.example
def test_a_variable_whose_start_hangs_on_an_uncertain_one_is_not_known() -> None:
    initial = {"sky": {"sun": 0.5, "rain": 0.5}, "hand": lambda sky: "dry" if sky == "sun" else "wet"}
    assert faults(initial=initial, known=["hand"])[0].startswith("known hand: found an uncertain start")
    fp.FactoredPOMDP(**parts(initial=initial | {"sky": "sun"}, known=["hand"]))


@pytest.mark.example
@pytest.mark.parametrize(
    ("part", "given", "expected"),
    [
        (
            "transition",
            {"sky": lambda hand_next: {"sun": 1.0}, "hand": lambda sky_next: "dry"},
            "transition: found a circle through sky, hand",
        ),
        (
            "initial",
            {"sky": lambda hand: "sun", "hand": lambda sky: "dry"},
            "initial: found a circle through sky, hand",
        ),
    ],
)
def test_circles(part: str, given: dict[str, Any], expected: str) -> None:
    assert any(expected in fault for fault in faults(**{part: given}))


@pytest.mark.example
def test_a_drift_is_noted() -> None:
    model = fp.FactoredPOMDP(**parts(initial={"sky": {"sun": 0.5, "rain": 0.499999}, "hand": "dry"}))
    assert model.notes == ("initial of sky: 1 of 1 distributions renormalised (worst sum 0.999999)",)
    assert model.initial["sky"].dense().array.sum() == pytest.approx(1.0, abs=1e-15)


@pytest.mark.example
def test_one_array_for_variables_of_different_values() -> None:
    numbers = np.array([[0.75, 0.25], [0.5, 0.5]])
    one, two = fp.Variable("one", ["a", "b"]), fp.Variable("two", ["c", "d"])
    three = fp.Variable("three", ["a", "b"])
    model = fp.FactoredPOMDP(
        states=[one, two, three],
        actions=[ACT],
        observations=[],
        transition={
            "one": fp.table("one", "one.next", values=numbers),
            "two": fp.table("two", "two.next", values=numbers),
            "three": fp.table("three", "three.next", values=[[1, 0], [0, 1]]),
        },
        reward={},
        initial={"one": [0.5, 0.5], "two": [0.5, 0.5], "three": [0.5, 0.5]},
        observation={},
    )
    assert model.transition["two"].scope == (two, two.next)
    belief = fp.initial_belief(model)
    assert belief.predict("in").block("two").value({"two": "c"}) == pytest.approx(0.625)
    assert fp.decompose(model).blocks == (("one",), ("two",), ("three",))


@pytest.mark.example
def test_an_array_and_its_transpose_are_two_tables() -> None:
    skewed = np.array([[0.5, 0.2, 0.3], [0.3, 0.5, 0.2], [0.2, 0.3, 0.5]])  # columns sum to one, too
    states = [fp.Variable(name, range(3)) for name in ("x", "y")]
    model = fp.FactoredPOMDP(
        states=states,
        actions=[ACT],
        observations=[],
        transition={
            "x": fp.table("x", "x.next", values=skewed),
            "y": fp.table("y", "y.next", values=skewed.T),
        },
        observation={},
        reward={},
        initial={"x": 0, "y": 0},
    )
    belief = fp.initial_belief(model).predict("in")
    np.testing.assert_allclose(belief.marginal("x"), [0.5, 0.2, 0.3])
    np.testing.assert_allclose(belief.marginal("y"), [0.5, 0.3, 0.2])


@pytest.mark.example
def test_actions_and_observations_are_read_from_mappings_or_single_values() -> None:
    model = fp.FactoredPOMDP(**parts(legal={"act": lambda hand, act: not (hand == "wet" and act == "out")}))
    assert model.action("out") == model.action({"act": "out"}) == {"act": "out"}
    assert model.observed("dark") == {"seen": "dark"}
    assert model.observed({}) == {}
    with pytest.raises(ValueError, match="'act' has no value 'up'"):
        model.action("up")
    with pytest.raises(ValueError, match="action: no value for act"):
        model.action({})
    with pytest.raises(ValueError, match=r"no observation variable 'see' \(did you mean 'seen'\?\)"):
        model.observed({"see": "dark"})
    assert not model.is_legal({"act": "out"}, {"hand": "wet"})
    assert model.is_legal({"act": "out"}, {"hand": "dry"})
    assert model.is_legal({"act": "out"}, {"hand": None})
