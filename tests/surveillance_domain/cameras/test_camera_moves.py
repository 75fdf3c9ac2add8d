"""Moves of an emulated camera, by hand-computed times: 100 degrees a second, 0.3 s to settle, 40 degrees away."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Limits, Outcome, Position
from surveillance_domain.cameras.errors import Refused, Unreachable
from surveillance_domain.cameras.mending import mend_of
from surveillance_domain.cameras.moving import Pace, drive
from surveillance_domain.cameras.steadiness import Steadiness
from surveillance_domain.cameras.witness import Witness
from surveillance_domain.emulation.virtual_clock import VirtualClock
from tests.emulated_cameras import emulated_pair


@pytest.mark.end_to_end
def test_a_move_takes_its_way_and_its_settling() -> None:
    with emulated_pair() as pair:
        there = pair.driver.move(pair.right, 5.0)
        assert there.outcome is Outcome.REACHED
        assert there.position == pair.right
        assert there.seconds == pytest.approx(0.4 + 0.3)
        assert there.because == ""
        assert pair.camera.motors.true() == pytest.approx((20.0, -40.0, 1.0))


@pytest.mark.end_to_end
def test_where_it_stands_it_is_at_once_but_only_once_it_is_known_to_be_still() -> None:
    with emulated_pair() as pair:
        assert pair.driver.move(pair.left, 5.0).seconds == pytest.approx(0.3)
        pair.clock.sleep(1.0)
        asked = pair.camera.questions
        assert pair.driver.move(pair.left, 5.0).seconds == 0.0
        assert pair.camera.questions == asked + 1  # the position, and no command


@pytest.mark.end_to_end
def test_zero_is_a_place_to_go_to() -> None:
    with emulated_pair() as pair:
        move = pair.driver.move(Position(0.0, 0.0, 1.0), 5.0)
        assert move.outcome is Outcome.REACHED
        assert pair.camera.motors.true() == pytest.approx((0.0, 0.0, 1.0))


@pytest.mark.end_to_end
def test_without_known_speeds_the_way_is_watched() -> None:
    with emulated_pair(pan_deg_per_s=None, tilt_deg_per_s=None) as pair:
        move = pair.driver.move(pair.right, 5.0)
        assert move.outcome is Outcome.REACHED
        assert 0.7 <= move.seconds <= 0.9  # it looks every tenth of a second


@pytest.mark.end_to_end
def test_a_move_that_takes_too_long_ends_with_the_budget() -> None:
    with emulated_pair() as pair:
        move = pair.driver.move(pair.right, 0.6)
        assert move.outcome is Outcome.TIMED_OUT
        assert move.seconds == pytest.approx(0.6)
        assert move.because == "it was at pan 20, tilt -40, zoom 1, but not still for long enough"
        assert move.fault == "NotThereInTime"
        cut_short = pair.driver.move(pair.left, 0.3)
        assert cut_short.because.endswith("on its way to pan -20, tilt -40, zoom 1")
        assert cut_short.fault == "NotThereInTime"
        pair.clock.sleep(5.0)
        assert pair.driver.move(pair.right, 5.0).outcome is Outcome.REACHED
        assert pair.driver.move(pair.right, 0.2).outcome is Outcome.REACHED


@pytest.mark.end_to_end
def test_a_position_that_stays_is_a_stalled_move() -> None:
    with emulated_pair() as pair:
        pair.camera.faults.frozen = True
        move = pair.driver.move(pair.right, 8.0)
        assert move.outcome is Outcome.STALLED
        assert move.position == pair.left
        assert move.seconds == pytest.approx(1.2)  # still for a second, at the third look
        assert move.because == "it stands at pan -20, tilt -40, zoom 1 instead of pan 20, tilt -40, zoom 1"
        assert move.fault == "StandsStill"
        short = pair.driver.move(pair.right, 0.9)
        assert (short.outcome, short.fault) == (Outcome.TIMED_OUT, "StandsStill")
        assert short.because == "it stood at pan -20, tilt -40, zoom 1 and did not set off to pan 20, tilt -40, zoom 1"
        assert mend_of(short.fault).startswith("it takes commands and does not turn")


@pytest.mark.end_to_end
def test_drift_beyond_the_tolerance_is_noticed() -> None:
    with emulated_pair() as pair:
        pair.camera.faults.pan_drift_deg_per_s = 0.001
        assert pair.driver.move(pair.right, 5.0).outcome is Outcome.REACHED
        pair.clock.sleep(3600.0)
        assert pair.driver.move(pair.right, 5.0).outcome is Outcome.STALLED  # it says 23.6 where it is sent to 20


@pytest.mark.end_to_end
def test_what_the_camera_would_clamp_is_not_sent() -> None:
    with emulated_pair(limits=Limits((-140.0, 140.0), (-90.0, 30.0), (1.0, 9999.0))) as pair:
        move = pair.driver.move(Position(150.0, 0.0, 1.0), 5.0)
        assert move.outcome is Outcome.STALLED
        assert "pan 150 is outside -140 to 140" in move.because
        assert pair.camera.motors.true() == (-20.0, -40.0, 1.0)


@pytest.mark.end_to_end
def test_a_lost_answer_costs_one_retry() -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.drop_share = 0.3
        for target in (pair.right, pair.left) * 5:
            assert pair.driver.move(target, 8.0).outcome is Outcome.REACHED
        assert pair.driver.health.failures <= 2


@pytest.mark.end_to_end
@pytest.mark.parametrize("fault", ["drop_share", "unavailable_share", "wrong_password"])
def test_a_camera_that_is_away_is_unreachable(fault: str) -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        setattr(pair.camera.faults, fault, type(getattr(pair.camera.faults, fault))(1))
        before = pair.clock.now()
        move = pair.driver.move(pair.right, 1.5)
        assert move.outcome is Outcome.UNREACHABLE
        assert "http://" in move.because
        assert "north" not in move.because
        assert pair.clock.now() - before <= 1.5


@pytest.mark.end_to_end
def test_a_late_camera_costs_no_more_than_the_budget() -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.latency_s = 60.0
        move = pair.driver.move(pair.right, 1.5)
        assert move.outcome is Outcome.UNREACHABLE
        assert move.seconds == pytest.approx(1.5)
        pair.camera.faults.latency_s = 0.1
        assert pair.driver.move(pair.right, 3.0).outcome is Outcome.REACHED


@pytest.mark.end_to_end
def test_three_failures_open_the_breaker_and_one_question_closes_it() -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.drop_share = 1.0
        for _ in range(3):
            assert pair.driver.move(pair.right, 1.5).outcome is Outcome.UNREACHABLE
        assert pair.driver.health.state == "away"
        asked = pair.camera.questions
        assert "left alone for another 30 s" in pair.driver.move(pair.right, 1.5).because
        assert pair.camera.questions == asked
        pair.clock.sleep(30.0)
        assert pair.driver.move(pair.right, 1.5).outcome is Outcome.UNREACHABLE
        assert pair.camera.questions == asked + 1  # one question, not four
        pair.clock.sleep(30.0)
        pair.camera.faults.drop_share = 0.0
        assert pair.driver.move(pair.right, 1.5).outcome is Outcome.REACHED
        assert pair.driver.health.state == "ready"


@pytest.mark.end_to_end
def test_after_a_reboot_limits_are_read_again() -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.reboot_in_move = True
        move = pair.driver.move(pair.right, 1.5)
        assert move.outcome is Outcome.UNREACHABLE
        pair.camera.motors.limits = Limits((-10.0, 10.0), (-90.0, 30.0), (1.0, 9999.0))
        pair.clock.sleep(46.0)
        assert pair.camera.motors.true() == (0.0, 0.0, 1.0)
        move = pair.driver.move(pair.right, 3.0)
        assert move.outcome is Outcome.STALLED
        assert "pan 20 is outside -10 to 10" in move.because
        assert pair.driver.limits == pair.camera.motors.limits


class Scripted:
    """Motors that lose answers: whether a command came through, and what the sender is told of it, are given."""

    def __init__(self, clock: VirtualClock, arrives: list[bool], errors: list[Exception | None]) -> None:
        self.steadiness, self.witness = Steadiness(0.1), Witness()
        self.clock, self.arrives, self.errors = clock, arrives, errors
        self.place, self.asked, self.said = Position(0.0, 0.0), 0, []

    def read(self, until: float) -> Position:
        self.said.append("read")
        self.steadiness.read(self.place, self.clock.now())
        return self.place

    def send(self, target: Position, until: float) -> None:
        self.said.append("send")
        number, self.asked = self.asked, self.asked + 1
        if self.arrives[number]:
            self.place = target
        error = self.errors[number]
        if error is not None:
            raise error


PACE = Pace(tolerance_deg=0.2, settle_s=0.3, travel_s=lambda here, there: 0.0)


def driven(arrives: list[bool], errors: list[Exception | None]) -> tuple[Outcome, list[str]]:
    clock = VirtualClock()
    motors = Scripted(clock, arrives, errors)
    return drive(motors, Position(5.0, 0.0), PACE, clock, np.random.default_rng(0), 8.0).outcome, motors.said


@pytest.mark.example
def test_after_a_time_out_the_position_is_asked_before_anything_is_sent_again() -> None:
    lost = Unreachable("no answer in time")
    outcome, said = driven([True], [lost])  # it came through, the answer did not
    assert outcome is Outcome.REACHED
    assert said[:3] == ["read", "send", "read"]
    assert said.count("send") == 1
    outcome, said = driven([False, True], [lost, None])  # it did not come through
    assert outcome is Outcome.REACHED
    assert said[:4] == ["read", "send", "read", "send"]


@pytest.mark.example
def test_a_refused_move_is_not_sent_again() -> None:
    outcome, said = driven([False], [Refused("Error: pan")])
    assert outcome is Outcome.UNREACHABLE
    assert said == ["read", "send"]


@pytest.mark.property
@settings(max_examples=25)
@given(
    st.lists(st.tuples(st.floats(-170, 170), st.floats(-90, 30), st.floats(0.05, 6)), min_size=1, max_size=3),
    st.floats(0, 0.5),
)
def test_a_move_keeps_its_budget_and_reached_means_there(moves: list[tuple[float, float, float]], drop: float) -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.drop_share = drop
        for pan, tilt, budget_s in moves:
            target = Position(pan, tilt, 1.0)
            move = pair.driver.move(target, budget_s)
            assert move.seconds <= budget_s + 1e-6
            if move.outcome is Outcome.REACHED:
                assert Position(*pair.camera.motors.true()).agrees(target, 0.2)
            assert (move.because == "") == (move.outcome is Outcome.REACHED)
