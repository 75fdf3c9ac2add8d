"""The grid truth's law against the filter's tables, which share no code with it; common random numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.stats import chisquare

from surveillance_domain.model.motion import motion_tables
from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.grid_chain import GridChain
from surveillance_domain.world.truth_grid import GridTruth

WALLS = ("reject", "reflect", "stay")
HALL = Grid(np.ones((10, 20), dtype=bool), cell_m=1.0)
PARAMETERS = MotionParameters(8, (1.5,), 15.0, 0.0, "reject", 1.0)


def table_law(grid: Grid, parameters: MotionParameters) -> np.ndarray:
    """P(d'|d,l,v') P(l'|l,d',v') of the filter's tables as ``[l, v', d, d', l']``."""
    tables = motion_tables(grid, parameters)
    speeds, directions = len(parameters.speeds_mps), parameters.directions
    location = np.zeros((grid.size, speeds, directions, grid.size))
    entries = tables.location
    location[entries.cell, entries.speed, entries.direction, entries.next_cell] = entries.probability
    direction = np.broadcast_to(tables.direction, (grid.size, speeds, directions, directions))
    return direction[..., None] * location[:, :, None]


@pytest.mark.property
@settings(max_examples=60)
@given(
    st.integers(1, 6).flatmap(
        lambda columns: st.lists(
            st.lists(st.sampled_from([True, True, False]), min_size=columns, max_size=columns), min_size=1, max_size=6
        )
    ),
    st.sampled_from(WALLS),
    st.integers(1, 9),
    st.sampled_from([(1.5,), (0.0, 1.0), (2.3, 0.4), (3.7,)]),
    st.sampled_from([0.0, 10.0, 15.0, 60.0]),
)
def test_the_law_is_that_of_the_tables(rows, walls, directions, speeds, sigma):
    grid = Grid(np.array(rows), cell_m=1.0)
    assume(grid.size > 0)
    parameters = MotionParameters(directions, speeds, sigma, 0.4, walls, 1.0)
    chain = GridChain(grid, parameters)
    expected = table_law(grid, parameters)
    for cell, speed, direction in np.ndindex(*expected.shape[:3]):
        outcomes = chain.outcomes(cell, direction, speed)
        found = np.zeros(expected.shape[3:])
        for (to_direction, to_cell), weight in zip(outcomes.pairs, outcomes.weights, strict=True):
            found[to_direction, to_cell] += weight
        assert np.abs(found - expected[cell, speed, direction]).max() < 1e-9
    speed_law = np.diff(np.array(chain.next_speeds), axis=1, prepend=0.0)
    assert np.abs(speed_law - motion_tables(grid, parameters).speed).max() < 1e-12


@pytest.mark.example
@pytest.mark.parametrize("walls", WALLS)
def test_drawn_steps_follow_the_law(walls):
    """Many targets in one state, beside a pillar and a wall: one step of all, chi-square at a fixed seed."""
    grid = Grid.from_rows(["......", "...#..", "......"], cell_m=1.0)
    parameters = MotionParameters(8, (1.0, 1.5), 40.0, 0.6, walls, 1.0)
    targets, cell, direction, speed = 4000, int(grid.number[1, 2]), 1, 0
    truth = GridTruth.initial(grid, parameters, targets, np.random.default_rng(7))
    same = np.ones(targets, dtype=np.int64)
    moved = replace(truth, cells=same * cell, directions=same * direction, speeds=same * speed).step()
    tables = motion_tables(grid, parameters)
    law = tables.speed[speed][:, None, None] * table_law(grid, parameters)[cell, :, direction]
    counts = np.zeros(law.shape)
    np.add.at(counts, (moved.speeds, moved.directions, moved.cells), 1)
    often = law * targets >= 5
    assert counts[law == 0].sum() == 0
    found = np.append(counts[often], counts[~often].sum())
    expected = np.append(law[often], law[~often].sum()) * targets
    assert chisquare(found, expected * found.sum() / expected.sum()).pvalue > 0.01


@pytest.mark.example
def test_a_target_moves_the_same_however_many_there_are():
    few = GridTruth.initial(HALL, PARAMETERS, 2, np.random.default_rng(3))
    many = GridTruth.initial(HALL, PARAMETERS, 9, np.random.default_rng(3))
    for _ in range(130):
        assert np.array_equal(few.cells, many.cells[:2])
        assert np.array_equal(few.directions, many.directions[:2])
        few, many = few.step(), many.step()
    assert len({tuple(state) for state in zip(many.cells, many.directions, strict=True)}) > 1


@pytest.mark.example
def test_a_step_leaves_the_truth_as_it_was_and_can_be_taken_again():
    truth = GridTruth.initial(HALL, PARAMETERS, 5, np.random.default_rng(4)).step()
    cells = truth.cells.copy()
    once, again = truth.step(), truth.step()
    assert np.array_equal(truth.cells, cells)
    assert np.array_equal(once.cells, again.cells)
    assert once.time == 2
    assert not np.array_equal(once.cells, truth.cells)


@pytest.mark.example
def test_another_seed_is_another_motion():
    one = GridTruth.initial(HALL, PARAMETERS, 20, np.random.default_rng(1))
    other = GridTruth.initial(HALL, PARAMETERS, 20, np.random.default_rng(2))
    assert not np.array_equal(one.cells, other.cells)


@pytest.mark.example
def test_first_states_are_uniform_or_follow_the_prior():
    grid = Grid.from_rows(["..", ".#"], cell_m=1.0)
    parameters = MotionParameters(4, (0.5, 1.0), 15.0, 0.1, "reject", 1.0)
    truth = GridTruth.initial(grid, parameters, 6000, np.random.default_rng(0))
    for drawn, values in ((truth.cells, 3), (truth.directions, 4), (truth.speeds, 2)):
        assert chisquare(np.bincount(drawn, minlength=values)).pvalue > 0.01
    there = GridTruth.initial(grid, parameters, 50, np.random.default_rng(0), np.array([0.0, 0.0, 2.0]))
    assert (there.cells == 2).all()


@pytest.mark.example
@pytest.mark.parametrize(
    ("prior", "wrong"),
    [
        (np.ones(7), "one weight for each of 200"),
        (np.full(200, -1.0), "not negative"),
        (np.zeros(200), "one of them positive"),
        (np.full(200, np.nan), "finite"),
    ],
)
def test_a_prior_that_does_not_fit_is_refused(prior, wrong):
    with pytest.raises(ValueError, match=wrong):
        GridTruth.initial(HALL, PARAMETERS, 1, np.random.default_rng(0), prior)


@pytest.mark.example
def test_targets_below_zero_and_grids_without_cells_are_refused():
    with pytest.raises(ValueError, match="targets is -1"):
        GridTruth.initial(HALL, PARAMETERS, -1, np.random.default_rng(0))
    with pytest.raises(ValueError, match="no free cell"):
        GridTruth.initial(Grid(np.zeros((2, 2), dtype=bool), 1.0), PARAMETERS, 1, np.random.default_rng(0))


@pytest.mark.example
def test_no_targets_is_a_world_like_any_other():
    truth = GridTruth.initial(HALL, PARAMETERS, 0, np.random.default_rng(0)).step()
    assert truth.cells.shape == (0,)
    assert truth.positions_m.shape == (0, 2)


@pytest.mark.example
def test_positions_are_the_cells_centres_in_metres():
    grid = Grid(np.ones((2, 3), dtype=bool), cell_m=0.5, origin_m=(10.0, -1.0))
    truth = GridTruth.initial(grid, PARAMETERS, 1, np.random.default_rng(0), np.array([0, 0, 0, 0, 0, 1.0]))
    assert truth.positions_m.tolist() == [[11.25, -0.25]]
