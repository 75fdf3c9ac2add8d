"""Sys and Stat: the presets they ask for, with and without slew, and when cameras do not do as they are told."""

from __future__ import annotations

import pytest

from surveillance_domain.control.base import Controller
from surveillance_domain.control.blind import StaticController, SystematicController
from surveillance_domain.control.loop import run_loop
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import Sighting
from tests.hand_made import hand_made

THREE_AND_TWO = {"a": {"1": [0], "2": [1], "3": [2]}, "b": {"1": [0], "2": [4]}}


def asked(surveillance: Surveillance, controller: Controller, steps: int) -> list[str]:
    """Joint presets asked for in a world that refuses what is out of reach, as ``"12"``."""
    record = run_loop(simulated_world(surveillance, "grid", 0, 0), controller, steps)
    assert all(step.sighting.views == step.choice.presets for step in record)
    return ["".join(step.choice.presets.values()) for step in record]


@pytest.mark.example
@pytest.mark.parametrize(
    ("phase", "expected"),
    [
        (0, ["11", "22", "31", "12", "21", "32", "11"]),
        (1, ["22", "31", "12", "21", "32", "11", "22"]),
        (5, ["32", "11", "22", "31", "12", "21", "32"]),
    ],
)
def test_sys_takes_every_preset_in_turn(phase, expected):
    """Preset (t + phase) mod |C| of every camera."""
    built = hand_made(["....."], THREE_AND_TWO)
    assert asked(built, SystematicController(built, phase), 7) == expected


@pytest.mark.example
def test_under_slew_sys_pans_back_over_the_presets_in_between():
    """From the third preset the first is two steps away: 1 2 3 (2) 1 2 3 (2) …"""
    built = hand_made(["....."], {"a": {"1": [0], "2": [1], "3": [2]}}, pan_deg_per_s=10.0)
    assert asked(built, SystematicController(built), 9) == list("123212321")
    assert asked(built, SystematicController(built, phase=2), 8) == list("23212321")


@pytest.mark.example
def test_sys_passes_over_presets_that_it_never_reaches():
    built = hand_made(["....."], THREE_AND_TWO, pan_deg_per_s=1.0)
    assert asked(built, SystematicController(built), 4) == ["11"] * 4
    assert asked(built, SystematicController(built, phase=1), 4) == ["11"] * 4


@pytest.mark.example
def test_sys_goes_on_from_where_its_cameras_really_are():
    built = hand_made(["....."], {"a": {"1": [0], "2": [1], "3": [2]}})
    controller = SystematicController(built)
    found = []
    for view in ("1", "1", "2", None, "1"):  # late in the second step, away in the fourth
        found.append(controller.choose().presets["a"])
        controller.see(Sighting({"target1": None}, {"a": view}, 0.0))
    assert found == ["1", "2", "2", "3", "1"]


@pytest.mark.example
def test_stat_holds_what_covers_most():
    """Alone, a's first preset (three cells) would be best; with b on two of these, its last one adds more."""
    views = {"a": {"1": [0, 1, 2], "2": [3], "3": [3, 4]}, "b": {"1": [2], "2": [0, 1, 2]}}
    built = hand_made(["....."], views)
    controller = StaticController(built)
    assert asked(built, controller, 4) == ["32"] * 4
    assert controller.choose().method == "the best coverage of the floor"


@pytest.mark.example
def test_under_slew_stat_gets_there_step_by_step():
    views = {"a": {"1": [0], "2": [1], "3": [2], "4": [3, 4, 5]}, "b": {"1": [0, 1], "2": [0]}}
    built = hand_made(["......"], views, pan_deg_per_s=10.0)
    assert asked(built, StaticController(built), 5) == ["21", "31", "41", "41", "41"]


@pytest.mark.example
def test_stat_stays_where_there_is_no_way():
    views = {"a": {"1": [0], "2": [1, 2]}}
    built = hand_made(["..."], views, pan_deg_per_s=1.0)
    assert asked(built, StaticController(built), 3) == ["1"] * 3


@pytest.mark.example
def test_stat_tries_again_where_a_camera_was_late():
    built = hand_made(["...."], {"a": {"1": [0], "2": [1], "3": [2, 3]}}, pan_deg_per_s=10.0)
    controller = StaticController(built)
    found = []
    for view in ("1", "2", "2", "3"):
        found.append(controller.choose().presets["a"])
        controller.see(Sighting({"target1": None}, {"a": view}, 0.0))
    assert found == ["2", "2", "3", "3"]
