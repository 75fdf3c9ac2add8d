"""Where a camera can be on its way: 80 degrees of pan and 40 of tilt, both at 100 degrees a second."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.world.way import along, places_on_the_way

START, GOAL, SPEEDS = Position(-40.0, -40.0, 1.0), Position(40.0, 0.0, 1.0), (100.0, 100.0, None)


@pytest.mark.example
@pytest.mark.parametrize(
    ("pan", "tilt", "possible"),
    [
        (-40.0, -40.0, True),
        (0.0, 0.0, True),  # each axis as fast as it can: after 0.4 s tilt is there and pan half-way
        (0.0, -20.0, True),  # both arrive together
        (40.0, 0.0, True),
        (40.0, -40.0, False),  # pan is there, and tilt has not set off
        (-40.0, 0.0, False),
        (0.0, -40.0, False),
        (41.0, 0.0, False),  # behind its goal
        (-41.0, -40.0, False),
    ],
)
def test_places_inside_of_the_box_that_are_on_the_way(pan: float, tilt: float, possible: bool) -> None:
    assert along(START, GOAL, Position(pan, tilt, 1.0), SPEEDS, 0.4) is possible


@pytest.mark.example
def test_without_known_speeds_all_of_the_box_is_on_the_way() -> None:
    assert along(START, GOAL, Position(40.0, -40.0, 1.0), (None, None, None), 0.4)
    assert not along(START, GOAL, Position(41.0, -40.0, 1.0), (None, None, None), 0.4)


@pytest.mark.example
def test_zoom_is_an_axis_where_it_is_told() -> None:
    assert not along(START, GOAL, Position(0.0, -20.0, 500.0), SPEEDS, 0.4)
    assert along(START, GOAL, Position(0.0, -20.0), SPEEDS, 0.4)


@pytest.mark.property
@given(st.floats(0, 2), st.floats(0.7, 1.4), st.booleans())
def test_both_ways_of_turning_are_on_the_way(passed_s: float, off: float, together: bool) -> None:
    """Data sheets may be off by a third or so."""
    pan = min(80.0, 100.0 * passed_s)
    tilt = pan / 2 if together else min(40.0, off * 100.0 * passed_s)
    assert along(START, GOAL, Position(-40.0 + pan, -40.0 + tilt, 1.0), SPEEDS, 0.4)


@pytest.mark.example
def test_places_that_it_may_have_come_to() -> None:
    places = list(places_on_the_way(START, GOAL, SPEEDS, 0.4))
    assert places[0] == START
    assert places[-1] == Position(0.0, -20.0, 1.0)
    assert list(places_on_the_way(START, GOAL, (None, None, None), 0.4))[-1] == GOAL
