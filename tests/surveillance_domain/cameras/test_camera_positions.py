"""Positions that agree, and limits."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Limits, Position
from surveillance_domain.cameras.steadiness import Steadiness

angles = st.floats(-360, 360)


@pytest.mark.example
def test_pan_goes_round_and_a_missing_zoom_agrees() -> None:
    assert Position(-179.9, 0.0).agrees(Position(179.95, 0.0), 0.2)
    assert not Position(-179.9, 0.0).agrees(Position(179.8, 0.0), 0.2)
    assert not Position(0.0, -179.9).agrees(Position(0.0, 179.95), 0.2)
    assert Position(0.0, 0.0, None).agrees(Position(0.0, 0.0, 5000.0), 0.2)
    assert not Position(0.0, 0.0, 1.0).agrees(Position(0.0, 0.0, 22.0), 0.2)


@pytest.mark.property
@given(angles, angles, st.floats(0.01, 10), st.integers(-3, 3))
def test_agreeing_is_symmetric_and_blind_to_full_turns(one: float, other: float, tolerance: float, turns: int) -> None:
    first, second = Position(one, 0.0), Position(other, 0.0)
    assert first.agrees(second, tolerance) == second.agrees(first, tolerance)
    assert first.agrees(Position(one + 360 * turns, 0.0), tolerance)


@pytest.mark.example
def test_limits_name_what_lies_outside() -> None:
    limits = Limits(pan=(-140.0, 140.0), zoom=(1.0, 9999.0))
    assert limits.faults(Position(140.0, 95.0, 1.0)) == ()
    assert limits.faults(Position(150.0, 0.0, 0.0)) == (
        "pan 150 is outside -140 to 140",
        "zoom 0 is outside 1 to 9999",
    )


@pytest.mark.example
def test_steadiness_counts_from_the_first_of_the_positions_that_agree() -> None:
    steadiness = Steadiness(0.1)
    assert steadiness.still_s(5.0) == 0.0
    steadiness.read(Position(0.0, 0.0), 1.0)
    steadiness.read(Position(0.09, 0.0), 2.0)
    assert steadiness.still_s(2.5) == 1.5
    steadiness.read(Position(0.12, 0.0), 3.0)  # near the one before, but not near that with which it began
    assert steadiness.still_s(3.5) == 0.5
    steadiness.forget()
    assert steadiness.still_s(4.0) == 0.0
