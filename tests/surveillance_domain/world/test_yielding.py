"""Who has a camera: moves that nobody here asked for, and how long it is left alone for them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.world.yielding import HELD, MOVED, Yielding, taken

LEFT, RIGHT, AWAY = Position(-40.0, -30.0, 1.0), Position(40.0, -30.0, 1.0), Position(0.0, -60.0, 1.0)
SPEEDS = (100.0, 100.0, None)


def watched(yield_s: float = 60.0) -> Yielding:
    """Of a camera that stands at its left preset, which it was sent to."""
    one = Yielding(0.2, yield_s, SPEEDS)
    one.read(LEFT, 0.0, 0.0)
    one.sent(LEFT, 0.0)
    one.accepted(LEFT)
    return one


def told(one: Yielding, position: Position, now_s: float) -> bool:
    """Whether it yields after a position that came at once."""
    one.read(position, now_s, now_s)
    return one.yields


def sent(one: Yielding, goal: Position, now_s: float, accepted: bool = True) -> None:
    one.sent(goal, now_s)
    if accepted:
        one.accepted(goal)
    else:
        one.failed()


@pytest.mark.example
def test_a_camera_where_it_was_left_is_ours() -> None:
    assert not told(watched(), Position(-40.15, -30.0, 1.0), 1.0)


@pytest.mark.example
def test_one_that_moved_by_itself_is_left_alone_until_it_has_been_still() -> None:
    one = watched(yield_s=60.0)
    assert told(one, AWAY, 10.0)
    assert told(one, RIGHT, 20.0)  # and moves on
    assert told(one, RIGHT, 79.9)
    assert not told(one, RIGHT, 80.0)
    assert told(one, AWAY, 90.0)  # and again


@pytest.mark.example
def test_slow_creeping_from_where_it_was_left_is_noticed() -> None:
    one = watched()
    assert [told(one, Position(-40.0 + 0.09 * second, -30.0, 1.0), float(second)) for second in (1, 2, 3)][-1]


@pytest.mark.example
def test_read_backs_that_drift_by_degrees_in_hours_are_ours() -> None:
    one = watched()
    for minute in range(1, 121):
        assert not told(one, Position(-40.0 + minute * 0.05, -30.0, 1.0), 60.0 * minute)


@pytest.mark.example
def test_a_drift_is_corrected_by_the_next_command_and_is_nobodys() -> None:
    """Every step asks for the left preset: nothing is sent while it agrees, and it is sent there once it does not."""
    one, drift = watched(), 0.0
    for minute in range(1, 121):
        drift += 0.05
        position = Position(-40.0 + drift, -30.0, 1.0)
        assert not told(one, position, 60.0 * minute)
        sent(one, LEFT, 60.0 * minute)
        if not position.agrees(LEFT, 0.2):
            drift = 0.0
            assert not told(one, LEFT, 60.0 * minute + 1.0)


@pytest.mark.example
def test_on_its_way_it_may_be_anywhere_between_and_nowhere_else() -> None:
    zoomed = Position(-40.0, -30.0, 4000.0)
    for found, yields in (
        (Position(3.0, -30.0, 1.0), False),
        (LEFT, False),
        (RIGHT, False),
        (AWAY, True),
        (zoomed, True),
    ):
        one = watched()
        sent(one, RIGHT, 1.0)
        assert told(one, found, 1.5) is yields


@pytest.mark.example
def test_away_from_its_goal_it_is_somebody_elses() -> None:
    one = watched()
    sent(one, RIGHT, 1.0)
    assert not told(one, Position(0.0, -30.0, 1.0), 1.5)
    assert told(one, Position(-10.0, -30.0, 1.0), 1.6)


@pytest.mark.example
def test_still_before_its_goal_somebody_stopped_it() -> None:
    one = watched()
    sent(one, RIGHT, 1.0)
    stop = Position(0.0, -30.0, 1.0)
    assert not told(one, stop, 1.4)
    assert not told(one, stop, 1.8)
    assert told(one, stop, 2.4)


@pytest.mark.example
@pytest.mark.parametrize(("deg_per_s", "yields"), [(5.0, True), (20.0, False)])
def test_a_crawl_on_its_way_is_somebody_at_the_joystick(deg_per_s: float, yields: bool) -> None:
    """At 100 degrees a second by the site; a fifth of that may be a camera that is slower than its data sheet."""
    one = watched()
    sent(one, RIGHT, 1.0)
    assert [told(one, Position(0.0 + deg_per_s * s, -30.0, 1.0), 1.4 + s) for s in (0.0, 0.3, 0.6)] == [
        False,
        False,
        yields,
    ]


@pytest.mark.example
def test_still_where_it_stood_the_command_may_not_have_come_through() -> None:
    one = watched()
    sent(one, RIGHT, 1.0)
    assert not told(one, LEFT, 20.0)
    assert not told(one, Position(0.0, -30.0, 1.0), 20.5)


@pytest.mark.example
def test_failures_do_not_hide_somebody_elses_move() -> None:
    one = watched()
    one.failed()
    assert told(one, AWAY, 1.5)


@pytest.mark.example
def test_a_command_whose_answer_was_lost_may_take_effect_for_half_a_minute() -> None:
    for passed_s, yields in ((9.0, False), (29.0, False), (31.0, True)):
        one = watched()
        sent(one, RIGHT, 1.0, accepted=False)
        for second in range(1, int(passed_s)):
            assert not told(one, LEFT, float(second))
        assert told(one, RIGHT, 1.0 + passed_s) is yields


@pytest.mark.example
def test_after_a_silence_in_which_it_may_have_rebooted_it_may_be_anywhere() -> None:
    one = watched()
    one.failed()
    assert not told(one, AWAY, 45.0)
    one.sent(RIGHT, 45.0)
    one.accepted(RIGHT)
    assert not told(one, Position(10.0, -55.0, 1.0), 45.2)  # it may still have been turning when it was sent
    assert not told(one, RIGHT, 46.0)
    assert told(one, AWAY, 47.0)


@pytest.mark.example
def test_a_silence_without_a_failure_is_no_reboot() -> None:
    assert told(watched(), AWAY, 45.0)


@pytest.mark.example
def test_a_camera_that_people_hold_is_judged_again_once_it_is_commanded() -> None:
    one = watched()
    one.let_go()
    assert not told(one, AWAY, 1.0)
    assert not told(one, AWAY, 2.0)
    assert not told(one, RIGHT, 3.0)
    sent(one, LEFT, 3.0)
    assert not told(one, LEFT, 4.0)
    assert told(one, AWAY, 5.0)


@pytest.mark.example
def test_one_that_is_sent_elsewhere_on_its_way_turns_there_and_then() -> None:
    """From (-40, -30) it has gone 40 degrees of pan when it is sent up; half a second later it is 30 degrees up."""
    one = watched()
    sent(one, RIGHT, 0.0)
    assert not told(one, Position(-10.0, -30.0, 1.0), 0.3)
    sent(one, Position(0.0, 10.0, 1.0), 0.4)
    assert not told(one, Position(0.0, 0.0, 1.0), 0.7)
    assert told(one, Position(-30.0, 0.0, 1.0), 0.8)


@pytest.mark.example
def test_a_read_back_that_had_stopped_shows_a_later_way() -> None:
    """It goes right, which its read-back does not show, and is on its way from there to `AWAY` when that comes back."""
    one = watched()
    sent(one, RIGHT, 0.0)
    assert not told(one, LEFT, 5.0)
    sent(one, AWAY, 5.0)
    assert not told(one, Position(30.0, -40.0, 1.0), 5.1)


@pytest.mark.example
def test_a_long_way_round_may_be_gone_either_way() -> None:
    one = Yielding(0.2, 60.0)
    start = Position(-170.0, 0.0)
    one.read(start, 0.0, 0.0)
    sent(one, Position(170.0, 0.0), 0.0)
    assert not told(one, Position(-178.0, 0.0), 1.0)


@pytest.mark.property
@given(
    st.lists(st.tuples(st.floats(-160, 160), st.floats(-80, 20)), min_size=1, max_size=5),
    st.floats(0.05, 3.0),
    st.floats(30.0, 120.0),
    st.booleans(),
)
def test_a_camera_that_only_does_as_it_is_told_never_yields(
    goals: list[tuple[float, float]], every_s: float, tilt_speed: float, accepted: bool
) -> None:
    """Its tilt may be slower or faster than the 100 degrees a second that the site says."""
    from surveillance_domain.emulation.kinematics import Journey

    one, now = Yielding(0.2, 60.0, SPEEDS), 0.0
    journey = Journey((0.0, 0.0, 1.0), (0.0, 0.0, 1.0), 0.0, (100.0, min(tilt_speed, 140.0), 1e9))
    for pan, tilt in goals:
        for _ in range(3):
            assert not told(one, Position(*journey.at(now)), now)
            now += every_s
        assert not told(one, Position(*journey.at(now)), now)
        sent(one, Position(pan, tilt, 1.0), now, accepted)
        journey = journey.onward((pan, tilt, 1.0), now)
    assert not told(one, Position(*journey.at(now + every_s)), now + every_s)


@pytest.mark.example
def test_taken_says_why() -> None:
    moved, free = watched(), watched()
    assert told(moved, AWAY, 1.0)
    assert taken({"a": moved, "b": free, "c": watched()}, {"b"}) == {"a": MOVED, "b": HELD}
    assert taken({"a": moved}, {"a"}) == {"a": HELD}
