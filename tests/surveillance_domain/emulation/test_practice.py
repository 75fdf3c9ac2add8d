"""Faults that people plan for emulated cameras: how they are written, and that they come and go."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import fields

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.emulation.fault_plan import GUARD_TOUR, JOYSTICK, KINDS, REBOOT, PlannedFault, read_plan
from surveillance_domain.emulation.faults import Faults
from surveillance_domain.emulation.practice import Practice
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.site.load import load_site

CAMERAS = ("south", "south:east")
"""A name may hold what the form is made of."""


@pytest.fixture
def running() -> Iterator[tuple[EmulatedSite, VirtualClock]]:
    clock = VirtualClock()
    with EmulatedSite(load_site("lego"), 1, clock, np.random.default_rng(0)) as emulated:
        yield emulated, clock


@pytest.mark.example
def test_every_fault_that_there_is_can_be_planned() -> None:
    assert set(KINDS) == {field.name for field in fields(Faults)} | {REBOOT, JOYSTICK, GUARD_TOUR}
    for kind in KINDS:
        ready = Faults()
        assert kind in (REBOOT, JOYSTICK, GUARD_TOUR) or (KINDS[kind].range is None) == isinstance(
            getattr(ready, kind), bool
        )


@pytest.mark.example
@pytest.mark.parametrize(
    ("text", "planned"),
    [
        ("south:latency_s=2@30-60", PlannedFault("south", "latency_s", 2.0, 30.0, 60.0)),
        ("south:drop-share=0.5", PlannedFault("south", "drop_share", 0.5, 0.0, math.inf)),
        ("south:east:frozen@1.5", PlannedFault("south:east", "frozen", None, 1.5, math.inf)),
        ("south:pan_slip_deg=-8@0-10", PlannedFault("south", "pan_slip_deg", -8.0, 0.0, 10.0)),
        ("south:reboot@5", PlannedFault("south", "reboot", None, 5.0, 5.0)),
        ("south:joystick@5", PlannedFault("south", "joystick", 10.0, 5.0, 8.0)),
        ("south:guard_tour=2@5-9", PlannedFault("south", "guard_tour", 2.0, 5.0, 9.0)),
    ],
)
def test_how_a_fault_is_written(text: str, planned: PlannedFault) -> None:
    assert read_plan([text], CAMERAS) == (planned,)


@pytest.mark.example
@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (["south"], "--fault south: expected CAMERA:KIND"),
        (["suth:frozen"], "no camera 'suth' (did you mean 'south'?)"),
        (["south:"], "no kind of fault ''"),
        (["south:latency=2"], "no kind of fault 'latency' (did you mean 'latency_s'?)"),
        (["south:latency_s"], "latency_s without a value; expected latency_s=NUMBER, 0 to 3600"),
        (["south:latency_s=soon"], "latency_s: found 'soon'; expected a number, 0 to 3600"),
        (["south:latency_s=nan"], "expected a number, 0 to 3600"),
        (["south:drop_share=1.5"], "drop_share: found '1.5'; expected a number, 0 to 1"),
        (["south:frozen=1"], "frozen takes no value"),
        (["south:frozen@soon"], "seconds: found 'soon'; expected a number, 0 or more"),
        (["south:frozen@-5"], "seconds: found ''"),
        (["south:frozen@9-9"], "ends at 9 s; expected later than 9 s"),
        (["south:frozen@1@2"], "expected KIND[=VALUE][@SECONDS[-SECONDS]] after the camera"),
        (["south:reboot@5-9"], "a reboot ends by itself"),
        (["south:frozen@1-5", "south:frozen@4"], "both at once; expected one after the other"),
    ],
)
def test_a_fault_that_is_written_wrong_is_refused(texts: list[str], said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)):
        read_plan(texts, CAMERAS)


@pytest.mark.example
def test_faults_come_and_go_and_are_told_of(running: tuple[EmulatedSite, VirtualClock]) -> None:
    emulated, _ = running
    faults = emulated.cameras["south"].faults
    texts = ["south:latency_s=2@1-3", "south:frozen@2", "south:latency_s=1@3-4"]
    practice = Practice(emulated, read_plan(texts, list(emulated.cameras)))
    assert (practice.advance(0.9), faults) == ([], Faults())
    assert practice.advance(1.0) == ["1 s: south: latency_s=2 begins"]
    assert practice.advance(2.05) == ["2 s: south: frozen begins"]
    assert (faults.latency_s, faults.frozen) == (2.0, True)
    assert practice.advance(3.0) == ["3 s: south: latency_s=2 ends", "3 s: south: latency_s=1 begins"]
    assert faults.latency_s == 1.0
    assert practice.advance(50.0) == ["4 s: south: latency_s=1 ends"]
    assert faults == Faults(frozen=True)
    assert emulated.cameras["north-east"].faults == Faults()


@pytest.mark.example
def test_people_push_and_tour(running: tuple[EmulatedSite, VirtualClock]) -> None:
    emulated, clock = running
    texts = ["south:joystick=20@1-3", "north-west:guard_tour=2@0-5", "north-east:reboot@1"]
    practice = Practice(emulated, read_plan(texts, list(emulated.cameras)))
    south, north_west = (emulated.cameras[name].motors for name in ("south", "north-west"))
    seen = []
    for tick in range(61):
        practice.advance(tick / 10)
        seen.append(north_west.true()[0])
        clock.sleep(0.1)
    assert south.true()[0] == pytest.approx(-40.0 + 2 * 20.0)  # from its first preset, 20 degrees a second for 2 s
    assert [seen[at] for at in (0, 19, 39, 60)] == [-40.0, 0.0, 40.0, -40.0]  # middle, right, left, and there it stays
    assert not emulated.cameras["north-east"].motors.awake()
