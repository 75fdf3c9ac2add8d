"""Cameras over HTTP as a world, in virtual time: pace, views, faults of one and not of all, people."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.base import HealthState, Outcome
from surveillance_domain.cameras.errors import CameraError
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.reachability import longest_move_s
from surveillance_domain.site.sections import PrivateArea
from surveillance_domain.world.base import World
from surveillance_domain.world.network import look_budget_s
from tests.emulated_watch import Emulated, emulated_watch, lego

ALL = {"south": "left", "north-west": "middle", "north-east": "right"}
MIDDLE = dict.fromkeys(ALL, "middle")


def sent(running: Emulated) -> dict[str, tuple[float, float, float]]:
    """Where the cameras really look."""
    return {name: camera.motors.true() for name, camera in running.emulation.cameras.items()}


@pytest.mark.end_to_end
def test_cameras_turn_and_are_looked_through_at_a_fixed_pace() -> None:
    with emulated_watch(lego(), 2, 1, wired=True) as running:
        world = running.world
        assert isinstance(world, World)
        for step, presets in enumerate((ALL, MIDDLE, ALL), 1):
            world.move(presets)
            sighting = world.observe()
            assert sighting.views == presets
            assert sighting.time_s == pytest.approx(1.5 * step)
            assert sighting.held == frozenset()
        assert set(sighting.observations) == {"red", "blue"}
        south = world.reports["south"]
        assert (south.sent, south.outcome, south.because, south.fault) == ("left", "reached", "", "")
        assert south.move_s == pytest.approx(0.4 + 0.3)  # 40 degrees at 100 a second, and settling
        assert south.position is not None
        assert south.position.pan == pytest.approx(-40.0)


@pytest.mark.end_to_end
def test_a_step_that_comes_too_late_begins_the_pace_anew() -> None:
    with emulated_watch(lego(), 1, 1) as running:
        running.world.move(ALL)
        running.world.observe()
        running.clock.sleep(4.0)
        running.world.move(MIDDLE)
        sighting = running.world.observe()
        assert sighting.views == MIDDLE  # there was time to turn all the same
        assert sighting.time_s == pytest.approx(1.5 + 4.0 + 1.5)
        assert running.world.late == 1
        running.world.move(ALL)
        assert running.world.observe().time_s == pytest.approx(8.5)
        assert running.world.late == 1


@pytest.mark.example
def test_looks_leave_time_for_the_longest_move() -> None:
    site = lego()
    assert longest_move_s(site.cameras[0], 1.5) == pytest.approx(0.8 + 0.3)
    assert look_budget_s(site) == pytest.approx(0.6 * (1.5 - 1.1))


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("fault", "value"),
    [
        ("latency_s", 30.0),
        ("latency_s", 0.3),
        ("drop_share", 1.0),
        ("unavailable_share", 1.0),
        ("wrong_password", True),
    ],
)
def test_a_sick_camera_costs_its_own_view_only_and_returns(fault: str, value: Any) -> None:
    """Between presets 80 degrees apart the others need 1.1 of 1.5 seconds."""
    with emulated_watch(lego(), 1, 1) as running:
        faults = running.emulation.cameras["south"].faults
        far = ({**ALL, "north-west": "right"}, {**ALL, "north-west": "left"})
        running.world.move(far[0])
        running.world.observe()
        setattr(faults, fault, value)
        for step in range(8):
            began = running.clock.now()
            running.world.move(far[step % 2])
            sighting = running.world.observe()
            assert sighting.views == {**far[step % 2], "south": None}
            assert running.clock.now() - began <= 1.5 + look_budget_s(running.site) + 0.05
        report = running.world.reports["south"]
        assert report.because
        assert "south" not in report.because + report.health.because  # who it is stands beside it
        assert report.fault in {"Unreachable", "Overloaded", "TooSlow", "CameraAway", "LoginRefused"}
        setattr(faults, fault, type(value)())
        running.clock.sleep(700.0)  # longer than it is left alone for, whatever the fault
        for _ in range(3):
            running.world.move(ALL)
            sighting = running.world.observe()
        assert sighting.views == ALL
        assert running.world.reports["south"].health.state is HealthState.READY


@pytest.mark.end_to_end
def test_a_camera_still_turning_has_no_view_and_goes_on() -> None:
    with emulated_watch(lego(), 1, 1) as running:
        motors = running.emulation.cameras["south"].motors
        motors._journey = type(motors._journey)(
            motors._journey.start, motors._journey.goal, 0.0, (20.0, 20.0, np.inf)
        )  # slower than the site says
        running.world.move({**ALL, "south": "right"})
        assert running.world.observe().views["south"] is None
        assert running.world.reports["south"].outcome == Outcome.TIMED_OUT
        for _ in range(3):
            running.world.move({**ALL, "south": "right"})
            sighting = running.world.observe()
        assert sighting.views["south"] == "right"
        assert sighting.held == frozenset()


@pytest.mark.end_to_end
def test_a_frozen_read_back_is_not_believed() -> None:
    with emulated_watch(lego(), 1, 1) as running:
        running.world.move(ALL)
        running.world.observe()
        running.emulation.cameras["south"].faults.frozen = True
        running.world.move({**ALL, "south": "right"})
        sighting = running.world.observe()
        assert sent(running)["south"][0] == pytest.approx(40.0)  # it went, and says it did not
        assert sighting.views["south"] is None
        assert sighting.held == frozenset()


@pytest.mark.end_to_end
def test_somebody_at_the_joystick_is_left_alone_and_their_view_counts() -> None:
    with emulated_watch(lego(yield_s=6.0), 1, 1) as running:
        running.world.move(ALL)
        running.world.observe()
        motors = running.emulation.cameras["south"].motors
        motors.command({"pan": "10"})
        sighting = running.world.observe()  # between two steps of the loop
        running.clock.sleep(1.0)
        sighting = running.world.observe()
        assert sighting.held == {"south"}
        assert sighting.views["south"] is None
        assert list(sighting.elsewhere) == ["south"]
        assert sighting.elsewhere["south"] == pytest.approx((10.0, -40.0, 1.0))
        running.world.move(MIDDLE)
        running.world.observe()
        assert sent(running)["south"][0] == pytest.approx(10.0)
        assert running.world.reports["south"].because == "moved by somebody else"
        motors.command({"pan": "40"})
        running.clock.sleep(1.0)
        assert running.world.observe().views["south"] == "right"
        for _ in range(int(6 / 1.5) + 2):
            running.world.move(MIDDLE)
            sighting = running.world.observe()
        assert sighting.views == MIDDLE
        assert sighting.held == frozenset()


@pytest.mark.end_to_end
def test_a_camera_turned_to_the_ceiling_or_to_what_is_private_has_no_view() -> None:
    with emulated_watch(lego(yield_s=6.0), 1, 1) as running:
        running.world.move(ALL)
        running.world.observe()
        running.emulation.cameras["south"].motors.command({"pan": "5", "tilt": "30"})
        running.clock.sleep(2.0)
        sighting = running.world.observe()
        assert (dict(sighting.elsewhere), sighting.private) == ({}, frozenset())
        assert "south" not in sighting.looking
    site = lego(yield_s=6.0)
    area = PrivateArea(polygon_m=((2.6, 0.0), (3.0, 0.0), (3.0, 0.9), (2.6, 0.9)))
    south = site.cameras[0].model_copy(update={"presets": site.cameras[0].presets[1:2]})
    with emulated_watch(replace(site, cameras=(south,), privacy=(area,)), 1, 1) as running:
        running.world.move({"south": "middle"})
        running.world.observe()
        running.emulation.cameras["south"].motors.command({"pan": "40", "tilt": "-30"})
        running.clock.sleep(2.0)
        sighting = running.world.observe()
        assert (dict(sighting.elsewhere), sighting.private, sighting.looking) == ({}, {"south"}, frozenset())
        assert sighting.observations == {"red": None}


@pytest.mark.end_to_end
def test_somebody_who_moves_it_while_it_is_commanded_or_looked_through_is_left_alone() -> None:
    """A look without a picture for it is no reason to forget where the camera was."""
    with emulated_watch(lego(), 1, 1) as running:
        running.world.move(ALL)
        running.world.observe()
        motors = running.emulation.cameras["south"].motors
        motors.command({"pan": "10", "tilt": "-60"})
        running.emulation.cameras["south"].faults.drop_share = 1.0
        assert running.world.observe().views["south"] is None
        running.emulation.cameras["south"].faults.drop_share = 0.0
        running.world.move({**ALL, "south": "right"})
        report = running.world.reports["south"]
        assert (report.sent, report.outcome, report.because, report.fault) == (None, "", "moved by somebody else", "")
        assert running.world.observe().held == {"south"}
        assert motors.true()[:2] == pytest.approx((10.0, -60.0))
        assert running.world.park()["south"].told == "left alone: moved by somebody else"


@pytest.mark.end_to_end
def test_a_slow_camera_is_told_so() -> None:
    from surveillance_domain.cameras.mending import mend_of

    with emulated_watch(lego(), 1, 1) as running:
        running.emulation.cameras["south"].faults.latency_s = 1.2
        for _ in range(3):
            running.world.move(dict.fromkeys(ALL, "left"))
            running.world.observe()
            report = running.world.reports["south"]
            assert "an answer takes it 1.2 s, and there were 1." in report.because
            assert report.fault == "TooSlow"
        assert "it answers, but too late" in mend_of(report.fault)
        running.emulation.cameras["south"].faults.latency_s = 30.0
        for _ in range(2):
            running.world.move(dict.fromkeys(ALL, "left"))
            running.world.observe()
        assert running.world.reports["south"].fault == "CameraAway"


@pytest.mark.end_to_end
def test_a_camera_that_answers_again_is_no_longer_said_to_be_left_alone() -> None:
    """When it should be turned it may not be asked for another half a second; when it is looked through it may."""
    with emulated_watch(lego(), 1, 1) as running:
        running.emulation.cameras["south"].faults.drop_share = 1.0
        while running.world.reports["south"].health.state is HealthState.READY:
            running.world.move(ALL)
            running.world.observe()
        running.emulation.cameras["south"].faults.drop_share = 0.0
        returns_s = running.world.reports["south"].health.returns_s
        assert returns_s is not None
        running.clock.sleep(returns_s - running.clock.now() - 0.5)
        running.world.move(ALL)
        assert "left alone for another 1 s" in running.world.reports["south"].because
        assert running.world.observe().views["south"] == "left"
        report = running.world.reports["south"]
        assert report.because == "not turned in this step: it had been left alone after failures, and answers again"
        assert report.health.state is HealthState.READY


@pytest.mark.end_to_end
def test_a_held_camera_gets_no_command_until_it_is_released() -> None:
    held: list[str] = ["north-east"]
    with emulated_watch(lego(), 1, 1, held=lambda: tuple(held)) as running:
        before = sent(running)["north-east"]
        running.world.move(MIDDLE)
        sighting = running.world.observe()
        assert sighting.held == {"north-east"}
        assert sighting.views == {**MIDDLE, "north-east": "left"}
        assert sent(running)["north-east"] == before
        assert running.world.reports["north-east"].sent is None
        held.clear()
        running.world.move(MIDDLE)
        assert running.world.observe().views == MIDDLE


@pytest.mark.end_to_end
def test_a_shadow_never_sends_a_move() -> None:
    commands: list[Any] = []
    with emulated_watch(lego(), 3, 1, moves=False) as running:
        for camera in running.emulation.cameras.values():
            camera.motors.command = commands.append  # type: ignore[method-assign]
        for step in islice(running.watch.turns(), 10):
            assert set(step.sighting.views.values()) == {"left"}
        assert commands == []
        assert all(camera.questions >= 10 for camera in running.emulation.cameras.values())


@pytest.mark.end_to_end
def test_park_sends_home_who_is_free() -> None:
    held: list[str] = ["north-east"]
    with emulated_watch(lego(), 1, 1, held=lambda: tuple(held)) as running:
        running.emulation.cameras["south"].faults.latency_s = 100.0
        done = running.world.park()
    assert {name: one.ok for name, one in done.items()} == {"south": False, "north-west": True, "north-east": True}
    assert done["north-west"].told == 'at "middle"'
    assert done["north-east"].told == "left alone: held"


@pytest.mark.end_to_end
def test_faults_at_the_start_are_told_and_do_not_stop_the_others() -> None:
    with emulated_watch(lego(), 1, 1) as running:
        running.emulation.cameras["south"].faults.wrong_password = True
        faults = running.world.start(5.0)
        assert set(faults) == {"south"}
        assert isinstance(faults["south"], CameraError)
        assert "password" in str(faults["south"])


@pytest.mark.end_to_end
def test_what_is_unknown_or_not_used_is_in_the_sighting() -> None:
    with emulated_watch(lego(), 1, 4, strangers=3) as running:
        met: set[str] = set()
        for step in islice(running.watch.turns(), 10):
            met |= set(step.sighting.unknown)
            assert step.observed <= 4
        assert met
        assert met <= {"marker 1", "marker 2", "marker 3"}


@pytest.mark.end_to_end
def test_pictures_go_through_the_same_loop() -> None:
    from surveillance_domain.model.build import surveillance_model
    from surveillance_domain.world.eyes import Eyes
    from surveillance_domain.world.picture_eyes import PictureEyes

    def eyes(emulation: EmulatedSite, drawn: Eyes) -> PictureEyes:
        return PictureEyes(surveillance_model(emulation.site, 2))

    made: Callable[[EmulatedSite, Eyes], Eyes] = eyes
    with emulated_watch(lego(), 2, 2, eyes=made, strangers=1) as running:
        seen, strangers, beyond = 0, set(), set()
        for step in islice(running.watch.turns(), 6):
            seen += step.observed
            strangers |= set(step.sighting.unknown)
            beyond |= set(step.sighting.beyond)
            met = {**step.sighting.observations, **step.sighting.unknown}
            assert all(met[name] is not None for name in step.sighting.beyond)
        assert seen > 3
        assert strangers <= {"marker 2"}
        assert beyond
        assert beyond <= {"red", "blue", "marker 2"}
        running.emulation.cameras["south"].faults.garbled_picture = True
        step = next(iter(running.watch.turns()))
        assert step.sighting.views["south"] is None
        assert running.world.reports["south"].fault == "BadPicture"
