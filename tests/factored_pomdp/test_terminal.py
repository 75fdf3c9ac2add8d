"""Terminal states: absorbing and worth nothing in the joint expansion, the end of an episode in a simulation."""

from __future__ import annotations

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.provenance import digest

PLACE = fp.Variable("place", ["left", "right"])
FUEL = fp.Variable("fuel", ["some", "none"])
PUSH = fp.Variable("push", ["on", "back"])


def walk(terminal: object) -> fp.FactoredPOMDP:
    """Two places and fuel that runs out half of the time; a step costs 1, arriving on the right earns 10."""
    return fp.FactoredPOMDP(
        states=[PLACE, FUEL],
        actions=[PUSH],
        observations=[],
        transition={
            "place": lambda push: "right" if push == "on" else "left",
            "fuel": lambda fuel: {"some": 0.5, "none": 0.5} if fuel == "some" else "none",
        },
        observation={},
        reward={"cost": -1.0, "arrival": fp.table("place.next", values=[0.0, 10.0])},
        initial={"place": "left", "fuel": "some"},
        discount=0.9,
        terminal=terminal,
    )


@pytest.mark.example
def test_terminal_states_are_absorbing_and_earn_nothing() -> None:
    flat = fp.joint(walk(lambda place: place == "right"))
    # left-some, left-none, right-some, right-none
    assert flat.terminal.tolist() == [False, False, True, True]
    on = flat.transition[0].toarray()
    assert on.tolist() == [[0, 0, 0.5, 0.5], [0, 0, 0, 1], [0, 0, 1, 0], [0, 0, 0, 1]]
    assert flat.reward.tolist() == [[9, 9, 0, 0], [-1, -1, 0, 0]]


@pytest.mark.example
def test_without_terminal_states_nothing_ends() -> None:
    model = walk(None)
    flat = fp.joint(model)
    assert not flat.terminal.any()
    assert flat.reward.tolist() == [[9, 9, 9, 9], [-1, -1, -1, -1]]
    assert not model.is_terminal({"place": "right", "fuel": "none"})


@pytest.mark.example
def test_simulation_stays_in_a_terminal_state() -> None:
    model = walk(fp.table("place", "fuel", values=[[0, 1], [0, 1]]))
    simulation, rng = fp.Simulation(model), np.random.default_rng(3)
    state = {"place": "left", "fuel": "some"}
    for _ in range(60):
        state, seen, reward = simulation.step(state, "on", rng)
        assert (seen, reward) == ({}, 9.0)
        if model.is_terminal(state):
            break
    assert state == {"place": "right", "fuel": "none"}
    assert simulation.step(state, "back", rng) == (state, {}, 0.0)


@pytest.mark.example
def test_terminal_of_one_variable_may_be_a_mapping() -> None:
    def gate(terminal: object) -> fp.FactoredPOMDP:
        return fp.FactoredPOMDP(
            states=[PLACE],
            actions=[PUSH],
            observations=[],
            transition={"place": lambda push: "right"},
            observation={},
            reward=1.0,
            initial={"place": "left"},
            terminal=terminal,
        )

    assert gate({"right": True}).is_terminal({"place": "right"})
    assert not gate({"right": True}).is_terminal({"place": "left"})
    assert digest(gate({"right": True})) != digest(gate({"left": True}))
    with pytest.raises(fp.ModelError, match=r"terminal: found 'place' has no value 'rigth' \(did you mean 'right'"):
        gate({"rigth": True})


@pytest.mark.example
def test_terminal_may_read_states_only() -> None:
    with pytest.raises(fp.ModelError, match="terminal: found a function of the unknown 'push'"):
        walk(lambda push: push == "on")
