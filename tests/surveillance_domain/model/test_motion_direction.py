"""Direction and speed without walls, against numbers worked out by hand and by quadrature."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.model.motion_direction import direction_table, speed_table, turning_deg


def normal_below(value: float) -> float:
    return 0.5 * math.erfc(-value / math.sqrt(2))


@pytest.mark.example
def test_straight_on_at_fifteen_degrees_and_eight_directions():
    table = direction_table(8, 15.0)
    assert table[0, 0] == pytest.approx(2 * normal_below(1.5) - 1, abs=1e-12)
    assert round(table[0, 0], 3) == 0.866
    assert table[3, 4] == pytest.approx(normal_below(4.5) - normal_below(1.5), abs=1e-12)


@pytest.mark.example
def test_no_spread_keeps_the_direction_and_great_spread_forgets_it():
    assert np.array_equal(direction_table(8, 0.0), np.eye(8))
    assert np.array_equal(direction_table(1, 20.0), np.eye(1))
    assert direction_table(8, 5000.0) == pytest.approx(np.full((8, 8), 1 / 8), abs=1e-12)


@pytest.mark.example
def test_far_bins_keep_their_digits():
    opposite = math.erfc(10.5 / math.sqrt(2)) - math.erfc(13.5 / math.sqrt(2))
    assert direction_table(8, 15.0)[0, 4] == pytest.approx(opposite, rel=1e-9)


@pytest.mark.property
@given(st.integers(2, 17), st.floats(0.5, 400.0))
def test_wrapped_gaussian_by_quadrature(directions, sigma_deg):
    table = direction_table(directions, sigma_deg)
    assert np.abs(table.sum(axis=1) - 1).max() < 1e-12
    width = 360.0 / directions
    samples = (np.arange(directions * 2000) + 0.5) * width / 2000 - width / 2
    turns = np.arange(-12, 13)[:, None] * 360.0
    density = np.exp(-0.5 * ((samples + turns) / sigma_deg) ** 2).sum(axis=0)
    masses = density.reshape(directions, 2000).sum(axis=1)
    masses /= masses.sum()
    for direction in range(directions):
        assert table[direction] == pytest.approx(np.roll(masses, direction), abs=1e-5)


@pytest.mark.example
def test_speeds_between_midpoints_with_open_ends():
    table = speed_table((0.0, 1.0, 3.0), 0.5)
    at_rest = [normal_below(1.0), normal_below(4.0) - normal_below(1.0), 1 - normal_below(4.0)]
    assert table[0] == pytest.approx(np.array(at_rest), abs=1e-12)
    assert table[1, 0] == pytest.approx(normal_below(-1.0), abs=1e-12)
    assert np.abs(table.sum(axis=1) - 1).max() < 1e-12


@pytest.mark.example
def test_order_of_the_speeds_does_not_matter():
    order = [2, 0, 1]
    ascending = speed_table((0.0, 1.0, 3.0), 0.7)
    shuffled = speed_table((3.0, 0.0, 1.0), 0.7)
    assert shuffled == pytest.approx(ascending[np.ix_(order, order)], abs=1e-15)


@pytest.mark.example
def test_one_speed_or_no_spread_keeps_the_speed():
    assert np.array_equal(speed_table((1.5,), 0.3), np.eye(1))
    assert np.array_equal(speed_table((0.5, 1.5), 0.0), np.eye(2))


@pytest.mark.example
def test_wide_bins_turn_less_than_sigma_and_narrow_ones_as_much():
    """At 8.64 degrees one turn in 109 leaves a bin of 45: P(|z| > 22.5 / 8.64) = 0.00921, 45 sqrt(0.00921) = 4.32."""
    assert turning_deg(8, 8.64) == pytest.approx(4.32, abs=0.01)
    assert turning_deg(72, 8.64) == pytest.approx(8.64, rel=0.02)
    assert turning_deg(8, 0.0) == 0.0
