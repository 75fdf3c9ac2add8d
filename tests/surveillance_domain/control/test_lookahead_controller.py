"""The controller lookahead: it turns a slow camera in time, chooses as P where it cannot know, and is a controller."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.lookahead import LookaheadChooser
from surveillance_domain.control.loop import run_loop
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.world.base import Sighting
from tests.hand_made import altered, hand_made

STILL = {"directions": 1, "speeds_mps": (0.0,)}
SLOW = {"a": {"left": [0], "middle": [2], "right": [4]}}
"""Presets lie 10 degrees apart, so 10 degrees a second reach the next one in a step, not the one after it."""


def ahead(surveillance: Surveillance, mass: list[float], preset: str, horizon: int = 5) -> PomdpController:
    """A controller that believes a target that does not move to be in these cells with these masses."""
    controller = PomdpController(surveillance, LookaheadChooser(surveillance, horizon))
    controller.belief = controller.belief.with_arrays([np.array(mass)[:, None]], {"a.preset": preset})
    return controller


@pytest.mark.example
def test_a_slow_camera_turns_past_an_empty_cell_to_where_the_target_is() -> None:
    """The target is in cell 4 for sure: P sees 0 from left and from middle and stays; over two steps, 1."""
    built = hand_made(["....."], SLOW, **STILL, pan_deg_per_s=10.0)
    sure = [0.0, 0.0, 0.0, 0.0, 1.0]
    controller = ahead(built, sure, "left")
    choice = controller.choose()
    assert choice.presets == {"a": "middle"}
    assert choice.value == pytest.approx(0.0)
    assert choice.upper_bound == pytest.approx(0.0)
    assert "not proved" in choice.method
    controller.see(Sighting({"target1": None}, {"a": "middle"}, 1.0))
    assert controller.choose().presets == {"a": "right"}
    short = ahead(built, sure, "left", horizon=1)
    assert short.choose().presets == {"a": "left"}


@pytest.mark.example
def test_a_small_chance_near_by_does_not_hold_it_back_from_a_large_one() -> None:
    """Left: 0.3 a step, 1.5 over five. Right: nothing on the way, then 0.7 a step four times, 2.8."""
    built = hand_made(["....."], SLOW, **STILL, pan_deg_per_s=10.0)
    assert ahead(built, [0.3, 0.0, 0.0, 0.0, 0.7], "left").choose().presets == {"a": "middle"}
    assert ahead(built, [0.3, 0.0, 0.0, 0.0, 0.7], "left", horizon=1).choose().presets == {"a": "left"}
    assert ahead(built, [0.9, 0.0, 0.0, 0.0, 0.1], "left").choose().presets == {"a": "left"}


@pytest.mark.example
def test_with_a_camera_away_it_chooses_as_p() -> None:
    views = {"a": {"left": [0, 1], "right": [3, 4]}, "b": {"left": [0, 1], "right": [3, 4]}}
    built = hand_made(["....."], views, **STILL)
    controllers = [PomdpController(built, LookaheadChooser(built)), PomdpController(built)]
    for controller in controllers:
        controller.choose()
        controller.see(Sighting({"target1": None}, {"a": None, "b": "left"}, 1.0))
    first, second = (controller.choose() for controller in controllers)
    assert first == second


@pytest.mark.example
def test_ties_keep_the_present_preset() -> None:
    built = hand_made(["....."], {"a": {"one": [0], "two": [1], "three": [2]}}, **STILL)
    nowhere = [0.0, 0.0, 0.0, 0.0, 1.0]
    for preset in ("one", "two", "three"):
        assert ahead(built, nowhere, preset).choose().presets == {"a": preset}


@pytest.mark.end_to_end
@pytest.mark.slow
def test_slow_cameras_see_more_of_one_target_than_with_p() -> None:
    """One target, cameras that reach only the next preset: more sightings over eight runs."""
    built = surveillance_model(altered("tiny", cameras={"*": {"pan_deg_per_s": 30.0}}, sigma_direction_deg=10.0), 1)
    reached = {"pomdp": [], "lookahead": []}
    for name, found in reached.items():
        for run in range(8):
            world = simulated_world(built, "grid", 5, run)
            record = run_loop(world, make_controller(name, built, Setting(world, 25, run)), 25)
            found.append(sum(step.observed for step in record))
    assert sum(reached["lookahead"]) > sum(reached["pomdp"])


@pytest.mark.example
def test_a_run_can_be_repeated() -> None:
    built = surveillance_model(altered("tiny", cameras={"*": {"detection_probability": 0.7}}), 2)

    def presets(run: int) -> list[dict[str, str]]:
        world = simulated_world(built, "grid", 3, run)
        record = run_loop(world, make_controller("lookahead", built, Setting(world, 5, run)), 5)
        return [dict(step.choice.presets) for step in record]

    assert presets(0) == presets(0)
