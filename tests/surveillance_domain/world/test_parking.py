"""Sending cameras home from outside of a run: whom somebody moves, or moved a moment ago, is left alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.base import Position
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.emulation.site import PASSWORD, EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.site.load import load_site
from surveillance_domain.world.memory import Memory, Stood
from surveillance_domain.world.parking import Parked, parked
from tests.direct_session import direct_session

LEGO = load_site("lego")
SITE = replace(LEGO, cameras=LEGO.cameras[:1])
LEFT = Position(*next((one.pan, one.tilt, one.zoom) for one in SITE.cameras[0].presets if one.name == "left"))
RIGHT = Position(*next((one.pan, one.tilt, one.zoom) for one in SITE.cameras[0].presets if one.name == "right"))
HOME = 'at "middle"'


class Noted(Memory):
    def __init__(self, stood: Stood | None = None) -> None:
        self.stood = stood

    def recall(self) -> Stood | None:
        return self.stood

    def keep(self, stood: Stood | None) -> None:
        self.stood = stood


@contextmanager
def emulated() -> Iterator[EmulatedSite]:
    with EmulatedSite(SITE, 1, VirtualClock(), np.random.default_rng(0)) as emulation:
        yield emulation


def park(emulation: EmulatedSite, memory: Memory, killed: bool = False) -> Parked:
    """The southern camera, which stands at its left preset unless it was turned."""
    (described,) = emulation.site.cameras
    session = direct_session(emulation.cameras["south"])
    camera = open_camera(described, emulation._clock, np.random.default_rng(1), session=session, password=PASSWORD)
    try:
        return parked(emulation.site, [camera], emulation._clock, (), {"south": memory}, {"south"} if killed else ())[
            "south"
        ]
    finally:
        camera.close()


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("stood", "told"),
    [
        (None, HOME),
        (Stood(LEFT, 12.4), "left alone: moved by somebody else 12 s ago"),
        (Stood(LEFT, 60.0), HOME),
        (Stood(Position(12.0, -30.0, 1.0), 12.4), "left alone: moved by somebody else 0 s ago"),  # and again
        (Stood(Position(12.0, -30.0, 1.0), 1e5), HOME),  # a day ago
    ],
)
def test_who_was_moved_before(stood: Stood | None, told: str) -> None:
    with emulated() as emulation:
        before = emulation.cameras["south"].motors.true()
        memory = Noted(stood)
        assert park(emulation, memory) == Parked(True, told)
        home = told == HOME
        assert (emulation.cameras["south"].motors.true() != before) == home
        assert (memory.stood is None) == home


@pytest.mark.end_to_end
def test_who_is_moved_while_it_is_parked_is_remembered() -> None:
    memory = Noted()
    with emulated() as emulation:
        emulation.cameras["south"].faults.pan_drift_deg_per_s = 5.0
        assert park(emulation, memory) == Parked(True, "left alone: somebody else turns it")
        assert memory.stood is not None
        assert memory.stood.still_s == 0.0
        emulation.cameras["south"].faults.pan_drift_deg_per_s = 0.0
        told = park(emulation, memory).told
    assert told == "left alone: moved by somebody else 0 s ago"


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("pan", "told"),
    [(-75.0, "left alone: moved by somebody else just now"), (RIGHT.pan, HOME)],
)
def test_who_comes_to_rest_at_no_preset_was_turned_by_somebody(pan: float, told: str) -> None:
    """A run that was killed can have sent it to presets only."""
    memory = Noted()
    with emulated() as emulation:
        motors = emulation.cameras["south"].motors
        motors.command({"pan": str(pan)})
        emulation._clock.sleep(0.2)
        before = motors.true()
        assert park(emulation, memory) == Parked(True, told)
        assert motors.true() != before
        assert (memory.stood is None) == (told == HOME)
        if memory.stood is not None:
            assert memory.stood.position.pan == pytest.approx(pan, abs=0.5)
            assert park(emulation, memory).told == "left alone: moved by somebody else 0 s ago"


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("pan", "killed", "told"),
    [
        (-75.0, True, "left alone: moved by somebody else just now"),
        (-75.0, False, HOME),  # nobody knows since when it stands there
        (RIGHT.pan, True, HOME),
    ],
)
def test_who_stands_at_no_preset_after_a_kill_is_left_alone(pan: float, killed: bool, told: str) -> None:
    memory = Noted()
    with emulated() as emulation:
        emulation.cameras["south"].motors.command({"pan": str(pan)})
        emulation._clock.sleep(5.0)
        assert park(emulation, memory, killed) == Parked(True, told)
        assert (memory.stood is None) == (told == HOME)
