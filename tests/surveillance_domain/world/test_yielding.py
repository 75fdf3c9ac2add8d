"""Who has a camera: moves that nobody here asked for, and how long it is left alone for them."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.world.yielding import HELD, MOVED, Yielding, taken

LEFT, RIGHT, AWAY = Position(-40.0, -30.0, 1.0), Position(40.0, -30.0, 1.0), Position(0.0, -60.0, 1.0)


def watched(yield_s: float = 60.0) -> Yielding:
    one = Yielding(0.2, yield_s)
    one.left_at(LEFT)
    one.found_at(LEFT, 0.0)
    return one


@pytest.mark.example
def test_a_camera_where_it_was_left_is_ours() -> None:
    one = watched()
    one.found_at(Position(-40.15, -30.0, 1.0), 1.0)
    assert not one.yields


@pytest.mark.example
def test_one_that_moved_by_itself_is_left_alone_until_it_has_been_still() -> None:
    one = watched(yield_s=60.0)
    one.found_at(AWAY, 10.0)
    assert one.yields
    one.found_at(RIGHT, 20.0)  # and moves on
    one.found_at(RIGHT, 79.9)
    assert one.yields
    one.found_at(RIGHT, 80.0)
    assert not one.yields
    one.found_at(AWAY, 90.0)  # not commanded since, so nobody can say that it was not us
    assert not one.yields
    one.left_at(AWAY)
    one.found_at(LEFT, 100.0)
    assert one.yields


@pytest.mark.example
def test_slow_creeping_from_where_it_was_left_is_noticed() -> None:
    one = watched()
    for second in range(1, 4):
        one.found_at(Position(-40.0 + 0.09 * second, -30.0, 1.0), float(second))
    assert one.yields


@pytest.mark.example
def test_on_its_way_it_may_be_anywhere_between_and_nowhere_else() -> None:
    for found, yields in ((Position(3.0, -30.0, 1.0), False), (LEFT, False), (RIGHT, False), (AWAY, True)):
        one = watched()
        one.sent_to(RIGHT)
        one.found_at(found, 1.5)
        assert one.yields is yields


@pytest.mark.example
def test_nothing_is_said_of_a_camera_that_failed() -> None:
    one = watched()
    one.left_at(None)
    one.found_at(AWAY, 1.5)
    assert not one.yields


@pytest.mark.example
def test_a_long_way_round_may_be_gone_either_way() -> None:
    one = Yielding(0.2, 60.0)
    one.left_at(Position(-170.0, 0.0))
    one.found_at(Position(-170.0, 0.0), 0.0)
    one.sent_to(Position(170.0, 0.0))
    one.found_at(Position(-178.0, 0.0), 1.0)
    assert not one.yields


@pytest.mark.property
@given(st.floats(0, 1), st.floats(-160, 160), st.floats(-80, 20), st.floats(-160, 160), st.floats(-80, 20))
def test_a_camera_that_only_does_as_it_is_told_never_yields(
    share: float, pan: float, tilt: float, to_pan: float, to_tilt: float
) -> None:
    one = Yielding(0.2, 60.0)
    start, goal = Position(pan, tilt), Position(to_pan, to_tilt)
    one.left_at(start)
    one.found_at(start, 0.0)
    one.sent_to(goal)
    one.found_at(Position(pan + share * (to_pan - pan), tilt + share * (to_tilt - tilt)), 1.0)
    assert not one.yields
    one.left_at(goal)
    one.found_at(goal, 2.0)
    assert not one.yields


@pytest.mark.example
def test_taken_says_why() -> None:
    moved, free = watched(), watched()
    moved.found_at(AWAY, 1.0)
    assert taken({"a": moved, "b": free, "c": watched()}, {"b"}) == {"a": MOVED, "b": HELD}
    assert taken({"a": moved}, {"a"}) == {"a": HELD}
