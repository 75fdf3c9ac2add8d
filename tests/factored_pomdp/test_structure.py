"""Which variables are known, and what belongs to which block."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.structure import structure_of

BIT = [0, 1]
ACT = fp.Variable("act", BIT)


def model(*, transition: dict[str, Any], initial: dict[str, Any], **more: Any) -> fp.FactoredPOMDP:
    """A model over bits."""
    given = {"observation": {}, "reward": {}} | more
    seen = [fp.Variable(name, given.pop("values", {}).get(name, BIT)) for name in given["observation"]]
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, BIT) for name in transition],
        actions=[ACT],
        observations=seen,
        transition=transition,
        initial=initial,
        **given,
    )


FAIR = {0: 0.5, 1: 0.5}


@pytest.mark.example
def test_functions_of_known_variables_and_actions_are_known_also_through_the_next_slice() -> None:
    found = structure_of(
        model(
            transition={
                "late": lambda early_next, late: (early_next + late) % 2,
                "early": lambda act, early: act ^ early,
                "hidden": lambda hidden: {hidden: 0.9, 1 - hidden: 0.1},
                "led": lambda hidden: hidden,
            },
            initial={"late": 0, "early": 1, "hidden": FAIR, "led": 0},
        )
    )
    assert found.known == ("late", "early")
    assert list(found.functions) == ["early", "late"]  # one that reads another's next value comes after it
    assert [block.names for block in found.blocks] == [("hidden", "led")]


@pytest.mark.example
def test_an_uncertain_start_is_not_known_though_it_moves_with_certainty() -> None:
    found = structure_of(model(transition={"x": lambda act: act, "y": lambda x: x}, initial={"x": FAIR, "y": 0}))
    assert found.known == ()


@pytest.mark.example
def test_declared_known_variables_may_move_by_chance() -> None:
    chance = {"x": lambda x: {x: 0.5, 1 - x: 0.5}, "y": lambda y, x: {y: 0.9, 1 - y: 0.1} if x else {y: 1.0}}
    undeclared = structure_of(model(transition=chance, initial={"x": 0, "y": FAIR}))
    assert undeclared.known == ()
    assert [block.names for block in undeclared.blocks] == [("x", "y")]
    declared = structure_of(model(transition=chance, initial={"x": 0, "y": FAIR}, known=["x"]))
    assert (declared.known, dict(declared.functions)) == (("x",), {})
    assert [block.names for block in declared.blocks] == [("y",)]


@pytest.mark.example
def test_what_is_read_after_a_step_does_not_help_a_prediction_that_reads_it_ahead() -> None:
    ahead = {"x": lambda x: {x: 0.5, 1 - x: 0.5}, "y": lambda x_next, y: {x_next: 0.9, y: 0.1} if x_next != y else y}
    found = structure_of(model(transition=ahead, initial={"x": 0, "y": FAIR}, known=["x"]))
    assert found.known == ()


@pytest.mark.example
def test_a_variable_shown_by_an_observation_is_known() -> None:
    chance = {"x": lambda x: {x: 0.5, 1 - x: 0.5}, "y": lambda y, x: {y: 0.9, 1 - y: 0.1} if x else {y: 1.0}}
    exact = structure_of(
        model(transition=chance, initial={"x": 0, "y": FAIR}, observation={"o": lambda x_next: 1 - x_next})
    )
    assert (exact.known, exact.shown_by) == (("x",), {"x": "o"})
    noisy = {"o": lambda x_next: {x_next: 0.99, 1 - x_next: 0.01}}
    assert structure_of(model(transition=chance, initial={"x": 0, "y": FAIR}, observation=noisy)).known == ()


@pytest.mark.example
def test_one_observation_cannot_show_two_variables_by_each_other() -> None:
    chance = {"x": lambda x: {x: 0.5, 1 - x: 0.5}, "y": lambda y: {y: 0.5, 1 - y: 0.5}}
    parity = {"o": lambda x_next, y_next: x_next ^ y_next}
    start = {"x": 0, "y": 0}
    assert structure_of(model(transition=chance, initial=start, observation=parity)).known == ()
    told = structure_of(model(transition=chance, initial=start, observation=parity, known=["y"]))
    assert (told.known, told.shown_by) == (("x", "y"), {"x": "o"})
    both = structure_of(model(transition=chance, initial=start, observation={"p": lambda y_next: y_next, **parity}))
    assert (both.known, list(both.shown_by.items())) == (("x", "y"), [("y", "p"), ("x", "o")])


@pytest.mark.example
def test_a_group_is_known_as_a_whole_or_not_at_all() -> None:
    moves = {"x": lambda act: act, "y": lambda y: {y: 0.9, 1 - y: 0.1}, "z": lambda act: act}
    start = {"x": 0, "y": FAIR, "z": 0}
    found = structure_of(model(transition=moves, initial=start, groups=[["x", "y"]]))
    assert found.known == ("z",)
    assert [block.names for block in found.blocks] == [("x", "y")]
    assert found.joins == ()


@pytest.mark.example
def test_blocks_hold_their_factors_without_idle_parents() -> None:
    found = structure_of(
        model(
            transition={
                "x": fp.table("x", "y", "act", "x.next", values=np.full((2, 2, 2, 2), 0.5)),
                "y": lambda y, act: {y: 0.75, act: 0.25} if y != act else y,
            },
            initial={"x": FAIR, "y": FAIR},
            observation={"o": lambda x_next, y_next: {x_next: 0.75, 1 - x_next: 0.25}},
            reward={"r": lambda y, x: float(y), "free": lambda act: float(act), "zero": lambda x, y_next: 0.0},
        )
    )
    x, y = found.blocks
    assert (x.transition["x"].names, y.transition["y"].names) == (("x.next",), ("y", "act", "y.next"))
    assert (list(x.likelihood), list(y.likelihood)) == (["o"], [])
    assert x.likelihood["o"].names == ("x.next", "o")
    assert [(name, factor.names) for name, factor in y.rewards] == [("r", ("y",))]
    assert [name for name, _ in found.free_rewards] == ["free", "zero"]


@pytest.mark.example
def test_a_known_variable_that_a_hidden_one_moves_tells_of_it() -> None:
    moves = {
        "alarm": lambda hidden: {1: 0.8, 0: 0.2} if hidden else 0,
        "hidden": lambda hidden: {hidden: 0.9, 1 - hidden: 0.1},
    }
    found = structure_of(model(transition=moves, initial={"alarm": 0, "hidden": FAIR}, known=["alarm"]))
    assert found.known == ("alarm",)
    (block,) = found.blocks
    assert (block.names, list(block.likelihood)) == (("hidden",), ["alarm"])
    assert "alarm.next" not in found.laws
    mixed = moves | {"alarm": lambda hidden, hidden_next: {1: 0.8, 0: 0.2} if hidden and hidden_next else 0}
    assert structure_of(model(transition=mixed, initial={"alarm": 0, "hidden": FAIR}, known=["alarm"])).known == ()
