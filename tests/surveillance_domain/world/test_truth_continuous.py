"""Continuous targets: they never enter a wall, and move as the numbers say where there is none."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.stats import chisquare, kstest

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.straight_move import first_wall
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth

WALLS = ("reject", "reflect", "stay")
HALL = Grid(np.ones((10, 20), dtype=bool), cell_m=1.0)


def motion(walls: str = "reject", **changes) -> MotionParameters:
    numbers = {
        "directions": 8,
        "speeds_mps": (1.5,),
        "sigma_direction_deg": 15.0,
        "sigma_speed_mps": 0.0,
        "walls": walls,
        "step_s": 1.0,
    }
    return MotionParameters(**{**numbers, **changes})


def one_target(grid: Grid, parameters: MotionParameters, x: float, y: float, heading_deg: float) -> ContinuousTruth:
    truth = ContinuousTruth.initial(grid, parameters, 1, np.random.default_rng(0))
    heading = np.array([math.radians(heading_deg)])
    speeds = np.array(parameters.speeds_mps[:1])
    return replace(truth, positions_m=np.array([[x, y]]), headings_rad=heading, speeds_mps=speeds)


@pytest.mark.property
@settings(max_examples=50)
@given(
    st.integers(1, 6).flatmap(
        lambda columns: st.lists(
            st.lists(st.sampled_from([True, True, False]), min_size=columns, max_size=columns), min_size=1, max_size=6
        )
    ),
    st.sampled_from(WALLS),
    st.sampled_from([(1.5,), (0.0, 0.7), (3.3,)]),
    st.sampled_from([0.0, 15.0, 80.0]),
    st.integers(0, 2**32 - 1),
)
def test_targets_never_enter_a_wall(rows, walls, speeds, sigma, seed):
    """Neither do they end in one, nor, as dense samples of rejected and unhindered moves show, go through one."""
    grid = Grid(np.array(rows), cell_m=0.7, origin_m=(-3.0, 11.0))
    assume(grid.size > 0)
    parameters = motion(walls, speeds_mps=speeds, sigma_direction_deg=sigma, sigma_speed_mps=0.2)
    truth = ContinuousTruth.initial(grid, parameters, 3, np.random.default_rng(seed))
    shares = np.linspace(0, 1, 41)[:, None, None]
    for _ in range(8):
        moved = truth.step()
        assert (moved.cells >= 0).all()
        if walls != "reflect":
            way = moved.positions_m - truth.positions_m
            assert (grid.number_at(truth.positions_m + shares * way) >= 0).all()
        truth = moved


@pytest.mark.property
@settings(max_examples=150)
@given(
    st.lists(st.lists(st.booleans(), min_size=5, max_size=5), min_size=5, max_size=5),
    st.tuples(st.floats(2.01, 2.99), st.floats(2.01, 2.99)),
    st.floats(0.0, 4.0),
    st.floats(0.0, 360.0),
)
def test_the_first_wall_is_where_dense_samples_find_it(rows, start, length, heading_deg):
    free = np.array(rows)
    free[2, 2] = True
    grid = Grid(free, cell_m=1.0)
    move = length * np.array([math.cos(math.radians(heading_deg)), math.sin(math.radians(heading_deg))])
    wall = first_wall(free, *start, float(move[0]), float(move[1]))
    shares = np.linspace(0, 1, 4001)
    blocked = grid.number_at(np.array(start) + shares[:, None] * move) < 0
    first_blocked = shares[blocked.argmax()] if blocked.any() else math.inf
    if wall is None:
        assert first_blocked > 1
    else:
        assert not blocked[shares < wall.share - 1e-9].any()
        # a sliver of a corner may fall between two samples; a wall that lasts for two of them may not
        beyond = grid.number_at(np.array(start) + min(1.0, wall.share + 1e-7) * move) < 0
        assert beyond or wall.share > 1 - 1e-6 or (wall.stops_x and wall.stops_y)


@pytest.mark.example
def test_no_slipping_between_two_blocks_but_past_one():
    free = np.array([[True, False], [False, True]])
    wall = first_wall(free, 0.5, 0.5, 1.0, 1.0)
    assert wall is not None
    assert (wall.share, wall.stops_x, wall.stops_y) == (0.5, True, True)
    free[0, 1] = True
    assert first_wall(free, 0.5, 0.5, 1.0, 1.0) is None


@pytest.mark.example
def test_a_corner_stops_what_its_blocked_side_stops():
    free = np.array([[True, False], [True, False]])
    wall = first_wall(free, 0.5, 0.5, 1.0, 1.0)
    assert wall is not None
    assert (wall.stops_x, wall.stops_y) == (True, False)


@pytest.mark.example
def test_straight_on_in_open_space():
    moved = one_target(HALL, motion(sigma_direction_deg=0.0), 5.2, 4.1, 60.0).step()
    assert moved.positions_m[0] == pytest.approx([5.2 + 0.75, 4.1 + 1.5 * math.sqrt(3) / 2], abs=1e-12)
    assert moved.directions.tolist() == [1]


@pytest.mark.example
def test_staying_stops_at_the_wall_and_keeps_the_heading():
    moved = one_target(HALL, motion("stay", sigma_direction_deg=0.0), 19.2, 5.5, 0.0).step()
    assert moved.positions_m[0] == pytest.approx([20.0, 5.5], abs=2e-6)
    assert moved.positions_m[0, 0] < 20.0
    assert moved.headings_rad.tolist() == [0.0]
    assert moved.step().positions_m[0] == pytest.approx(moved.positions_m[0], abs=2e-6)


@pytest.mark.example
def test_reflecting_goes_the_rest_of_the_way_back():
    moved = one_target(HALL, motion("reflect", sigma_direction_deg=0.0), 19.2, 5.5, 0.0).step()
    assert moved.positions_m[0] == pytest.approx([19.3, 5.5], abs=1e-5)
    assert moved.directions.tolist() == [4]
    corner = one_target(HALL, motion("reflect", sigma_direction_deg=0.0), 19.5, 9.5, 45.0).step()
    back = 1.5 / math.sqrt(2) - 0.5
    assert corner.positions_m[0] == pytest.approx([20 - back, 10 - back], abs=1e-5)
    assert corner.directions.tolist() == [5]


@pytest.mark.example
def test_rejecting_takes_the_nearest_open_heading_where_none_is_drawn():
    """Before a wall 0.2 away and without spread, 1.5 long: open from arccos(0.2 / 1.5) = 82.3 degrees on."""
    moved = one_target(HALL, motion(sigma_direction_deg=0.0), 19.8, 5.0, 0.0).step()
    assert abs(math.degrees(moved.headings_rad[0])) == pytest.approx(83.0, abs=1e-9)


@pytest.mark.example
@pytest.mark.parametrize("sigma", [0.0, 30.0])
def test_rejecting_without_any_open_heading_stays(sigma):
    grid = Grid.from_rows(["."], cell_m=1.0)
    moved = one_target(grid, motion(speeds_mps=(3.0,), sigma_direction_deg=sigma), 0.4, 0.7, 20.0).step()
    assert moved.positions_m.tolist() == [[0.4, 0.7]]
    assert math.degrees(moved.headings_rad[0]) == pytest.approx(20.0)


@pytest.mark.example
def test_rejected_headings_are_drawn_from_the_open_part_of_the_gaussian():
    """Along a wall on the left, half of the Gaussian is open: the turn is half-normal to the right."""
    parameters = motion(speeds_mps=(1.0,))
    truth = ContinuousTruth.initial(HALL, parameters, 400, np.random.default_rng(8))
    ones = np.ones(400)
    truth = replace(truth, positions_m=np.stack([ones * 10.0, ones * (10 - 1e-9)], axis=1), headings_rad=ones * 0.0)
    turned = np.degrees(truth.step().headings_rad)
    assert kstest(-turned / 15.0, "halfnorm").pvalue > 0.01


@pytest.mark.example
def test_turns_and_speeds_have_the_spread_that_is_asked_for():
    wide = Grid(np.ones((100, 100), dtype=bool), cell_m=1.0)
    parameters = motion(speeds_mps=(0.0, 1.0, 9.0), sigma_speed_mps=0.3)
    truth = ContinuousTruth.initial(wide, parameters, 1000, np.random.default_rng(9))
    ones = np.ones(1000)
    truth = replace(truth, positions_m=np.full((1000, 2), 50.0), headings_rad=ones * 1.0, speeds_mps=ones * 1.0)
    moved = truth.step()
    assert kstest(np.degrees(moved.headings_rad - 1.0) / 15.0, "norm").pvalue > 0.01
    inside = moved.speeds_mps[moved.speeds_mps > 0]
    assert kstest((inside - 1.0) / 0.3, "norm").pvalue > 0.01
    travelled = np.hypot(*(moved.positions_m - truth.positions_m).T)
    assert travelled == pytest.approx(moved.speeds_mps, abs=1e-12)
    assert np.array_equal(moved.speeds, (moved.speeds_mps >= 0.5).astype(int))


@pytest.mark.example
def test_speeds_are_kept_within_the_set():
    parameters = motion(speeds_mps=(0.5, 1.0), sigma_speed_mps=5.0)
    moved = ContinuousTruth.initial(HALL, parameters, 100, np.random.default_rng(1)).step()
    assert set(np.round(moved.speeds_mps, 12)) >= {0.5, 1.0}
    assert moved.speeds_mps.min() == 0.5
    assert moved.speeds_mps.max() == 1.0
    single = ContinuousTruth.initial(HALL, motion(sigma_speed_mps=5.0), 10, np.random.default_rng(1)).step()
    assert (single.speeds_mps == 1.5).all()


@pytest.mark.example
def test_the_first_positions_are_uniform_over_the_free_area():
    grid = Grid.from_rows(["..", ".#"], cell_m=2.0, origin_m=(1.0, 1.0))
    truth = ContinuousTruth.initial(grid, motion(), 4000, np.random.default_rng(2))
    assert chisquare(np.bincount(truth.cells, minlength=3)).pvalue > 0.01
    assert kstest((truth.positions_m[truth.cells == 0] - 1.0).ravel() / 2.0, "uniform").pvalue > 0.01
    assert kstest(truth.headings_rad / (2 * math.pi), "uniform").pvalue > 0.01


@pytest.mark.example
@pytest.mark.parametrize("directions", [1, 5, 8])
def test_both_truths_start_in_the_same_states(directions):
    parameters = motion(directions=directions, speeds_mps=(0.5, 1.0))
    grid_truth = GridTruth.initial(HALL, parameters, 50, np.random.default_rng(6))
    truth = ContinuousTruth.initial(HALL, parameters, 50, np.random.default_rng(6))
    assert np.array_equal(truth.cells, grid_truth.cells)
    assert np.array_equal(truth.directions, grid_truth.directions)
    assert np.array_equal(truth.speeds, grid_truth.speeds)


@pytest.mark.example
@pytest.mark.parametrize("walls", WALLS)
def test_a_target_moves_the_same_however_many_there_are(walls):
    few = ContinuousTruth.initial(HALL, motion(walls), 2, np.random.default_rng(3))
    many = ContinuousTruth.initial(HALL, motion(walls), 6, np.random.default_rng(3))
    start = many.positions_m
    for _ in range(40):
        few, many = few.step(), many.step()
        assert np.array_equal(few.positions_m, many.positions_m[:2])
    assert not np.array_equal(start, many.positions_m)
