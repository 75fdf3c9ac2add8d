"""Motors by hand: 100 degrees a second in pan, 50 in tilt, 1000 zoom positions a second."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Limits
from surveillance_domain.emulation.kinematics import Journey
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.virtual_clock import VirtualClock

LIMITS = Limits((-170.0, 170.0), (-30.0, 90.0), (1.0, 9999.0))
SPEEDS = (100.0, 50.0, 1000.0)


def motors() -> tuple[EmulatedMotors, VirtualClock]:
    clock = VirtualClock()
    return EmulatedMotors((0.0, 0.0, 1.0), LIMITS, SPEEDS, clock), clock


@pytest.mark.example
def test_every_axis_at_its_own_speed() -> None:
    turned, clock = motors()
    turned.command({"pan": "-100", "tilt": "40", "zoom": "501"})
    clock.sleep(0.5)
    assert turned.told() == pytest.approx((-50.0, 25.0, 501.0))
    clock.sleep(0.3)
    assert turned.true() == pytest.approx((-80.0, 40.0, 501.0))
    turned.command({"pan": "0"})  # half-way back; tilt goes on to where it was sent
    clock.sleep(0.4)
    assert turned.true() == pytest.approx((-40.0, 40.0, 501.0))


@pytest.mark.example
def test_beyond_the_limits_is_clamped_without_a_word() -> None:
    turned, clock = motors()
    turned.command({"pan": "250", "tilt": "-90", "zoom": "99999"})
    clock.sleep(60.0)
    assert turned.told() == (170.0, -30.0, 9999.0)
    turned.command({"rpan": "-10", "rtilt": "5"})
    clock.sleep(60.0)
    assert turned.told() == (160.0, -25.0, 9999.0)
    turned.command({"move": "home"})
    clock.sleep(60.0)
    assert turned.told() == (0.0, 0.0, 1.0)
    for bad in ("x", "nan", "inf", ""):
        with pytest.raises(ValueError, match="pan: invalid value"):
            turned.command({"pan": bad})


@pytest.mark.example
def test_frozen_and_drifting_positions_are_told_but_not_true() -> None:
    turned, clock = motors()
    turned.faults.frozen = True
    assert turned.told() == (0.0, 0.0, 1.0)
    turned.command({"pan": "50"})
    clock.sleep(1.0)
    assert turned.told() == (0.0, 0.0, 1.0)
    assert turned.true() == (50.0, 0.0, 1.0)
    turned.faults.frozen = False
    assert turned.told() == (50.0, 0.0, 1.0)
    turned.faults.pan_drift_deg_per_s = 0.01
    turned.told()
    clock.sleep(100.0)
    assert turned.told() == pytest.approx((51.0, 0.0, 1.0))
    assert turned.true() == (50.0, 0.0, 1.0)


@pytest.mark.example
def test_a_reboot_in_mid_move_stops_there_and_comes_back_straight() -> None:
    turned, clock = motors()
    turned.faults.reboot_in_move = True
    turned.command({"pan": "100"})
    clock.sleep(0.4)
    assert turned.awake()
    assert turned.true()[0] == pytest.approx(40.0)
    clock.sleep(0.1)
    assert not turned.awake()
    clock.sleep(44.9)
    assert not turned.awake()
    clock.sleep(0.2)
    assert turned.awake()
    assert turned.told() == (0.0, 0.0, 1.0)
    assert turned.rebooted()
    assert not turned.rebooted()
    assert not turned.faults.reboot_in_move


axes = st.tuples(st.floats(-170, 170), st.floats(-30, 90), st.floats(1, 9999))
speeds = st.tuples(*[st.one_of(st.floats(1, 1000), st.just(math.inf))] * 3)


@pytest.mark.property
@given(axes, axes, speeds, st.floats(0, 10), st.floats(0, 10))
def test_an_axis_never_overshoots_nor_exceeds_its_speed(
    start: tuple[float, float, float],
    goal: tuple[float, float, float],
    pace: tuple[float, float, float],
    one: float,
    later: float,
) -> None:
    journey = Journey(start, goal, 0.0, pace)
    first, second = journey.at(one), journey.at(one + later)
    for a, b, here, there, v in zip(start, goal, first, second, pace, strict=True):
        assert min(a, b) - 1e-9 <= here <= max(a, b) + 1e-9
        assert abs(b - there) <= abs(b - here) + 1e-9
        assert abs(there - here) <= v * later + 1e-6 or math.isinf(v)
    assert journey.at(journey.ends_s + 1e-6) == pytest.approx(goal, abs=1e-2)
