"""The loop's order of events, the measure PercentObs and its interval, controllers by name."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from surveillance_domain.control.base import Choice
from surveillance_domain.control.factory import CONTROLLERS, NAMES, Setting, make_controller
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.control.percent_obs import confidence_interval, percent_obs
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import surveillance_model
from surveillance_domain.world.base import Sighting, TrueWorld, World
from tests.hand_made import altered


@pytest.mark.example
def test_choose_move_observe_learn():
    events = []
    told = []

    def noted(event, result=None):
        return lambda *given: events.append((event, *given)) or result

    choice, sighting = Choice({"a": "left"}), Sighting({"t": None}, {"a": "left"}, 1.0)
    controller = SimpleNamespace(restarts=0, choose=noted("choose", choice), see=noted("see"))
    world = SimpleNamespace(move=noted("move"), observe=noted("observe", sighting))
    record = run_loop(world, controller, 2, told.append)
    once = [("choose",), ("move", {"a": "left"}), ("observe",), ("see", sighting)]
    assert events == once + once
    assert told == record
    assert [step.number for step in record] == [1, 2]
    assert all(step.choice is choice and step.sighting is sighting and step.decision_ms >= 0 for step in record)


@pytest.mark.example
def test_no_steps_are_an_empty_record():
    world = SimpleNamespace(move=pytest.fail, observe=pytest.fail)
    assert run_loop(world, SimpleNamespace(restarts=0, choose=pytest.fail, see=pytest.fail), 0) == []


def step(*seen: bool) -> Step:
    observations = {f"t{number}": (0, 0) if yes else None for number, yes in enumerate(seen)}
    return Step(1, Choice({}), Sighting(observations, {}, 0.0), 0.0)


@pytest.mark.example
def test_percent_obs_is_the_mean_share_over_steps_with_targets():
    """Shares 1/2, 1, 0 of the targets present, and a step without any, which does not count: 50 %."""
    record = [step(True, False), step(True), step(False, False, False), step()]
    assert percent_obs(record) == pytest.approx(50.0)
    assert [(s.observed, s.present) for s in record] == [(1, 2), (1, 1), (0, 3), (0, 0)]
    assert math.isnan(percent_obs([step()]))
    assert math.isnan(percent_obs([]))


@pytest.mark.example
def test_the_confidence_interval_is_students():
    """1 … 5: mean 3, standard error √(2.5 / 5) = 0.70711, t(0.975, 4) = 2.77645, half width 1.96324."""
    low, high = confidence_interval([1.0, 2.0, 3.0, 4.0, 5.0])
    assert (low, high) == (pytest.approx(3 - 1.96324, abs=1e-5), pytest.approx(3 + 1.96324, abs=1e-5))
    assert confidence_interval([4.0]) == (-math.inf, math.inf)
    assert confidence_interval([2.0, 2.0, 2.0]) == (2.0, 2.0)


@pytest.mark.example
def test_every_controller_has_a_name_and_runs():
    built = surveillance_model(altered("tiny", cameras={"*": {"detection_probability": 0.8}}), 2)
    assert set(NAMES) == set(CONTROLLERS)
    for name in CONTROLLERS:
        world = simulated_world(built, "grid", 1, 0)
        assert isinstance(world, World)
        assert isinstance(world, TrueWorld)
        record = run_loop(world, make_controller(name, built, Setting(world, 6)), 6)
        assert [set(s.choice.presets) for s in record] == [{"south-west", "north-east"}] * 6
        assert all(s.present == 2 for s in record)


@pytest.mark.example
def test_the_run_number_is_the_phase_of_sys():
    built = surveillance_model(altered("tiny"), 1)
    world = simulated_world(built, "grid", 1, 0)
    first = [make_controller("sys", built, Setting(world, 5, run)).choose().presets["north-east"] for run in range(4)]
    assert first == ["left", "middle", "right", "left"]


@pytest.mark.example
def test_an_unknown_controller_is_refused_with_those_that_there_are():
    built = surveillance_model(altered("micro"), 1)
    with pytest.raises(ValueError, match=r"no controller 'mdp' \(there are: pomdp, mp, .*clairvoyant.*\)"):
        make_controller("mdp", built, Setting(simulated_world(built, "grid", 0, 0), 1))
