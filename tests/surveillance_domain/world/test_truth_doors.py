"""Targets that come and go, in both truths: by the law of the tables, and by the geometry of the doors."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from surveillance_domain.control.factory import CONTROLLERS
from surveillance_domain.control.loop import run_loop
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.experiments.runs import prepared_run, simulate_run
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.model.motion import motion_tables
from surveillance_domain.model.parameters import DoorParameters, MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Door
from surveillance_domain.world.grid_chain import GridChain
from surveillance_domain.world.truth import OUTSIDE
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth

WALLS = ("reject", "reflect", "stay")
HALL = Grid(np.ones((6, 8), dtype=bool), cell_m=1.0)
DOORS = (DoorParameters(((0, 2), (0, 3)), 0.3), DoorParameters(((7, 0),), 0.1))
PARAMETERS = MotionParameters(8, (1.5,), 30.0, 0.0, "reject", 1.0, DOORS)


def tiny_with_a_door(targets: int = 4, rate_per_s: float = 0.2) -> Surveillance:
    site = load_site("tiny")
    doors = (Door(cells=((0, 1), (0, 2)), rate_per_s=rate_per_s),)
    return surveillance_model(replace(site, targets=site.targets.model_copy(update={"doors": doors})), targets)


@pytest.mark.property
@settings(max_examples=40)
@given(
    st.integers(1, 5).flatmap(
        lambda columns: st.lists(
            st.lists(st.sampled_from([True, True, False]), min_size=columns, max_size=columns), min_size=1, max_size=5
        )
    ),
    st.sampled_from(WALLS),
    st.integers(1, 9),
    st.sampled_from([(1.5,), (0.0, 1.0), (2.3, 0.4), (3.7,)]),
    st.sampled_from([0.0, 15.0, 60.0]),
    st.data(),
)
def test_the_law_with_doors_is_that_of_the_tables(rows, walls, directions, speeds, sigma, data) -> None:
    grid = Grid(np.array(rows), cell_m=1.0)
    assume(grid.size > 0)
    cells = data.draw(st.permutations([tuple(cell) for cell in grid.cells.tolist()]))
    rates = data.draw(st.sampled_from([(0.3, 0.1), (0.0, 0.0), (0.0, 2.0)]))
    doors = (
        DoorParameters(tuple(cells[:2]), rates[0]),
        *([DoorParameters((cells[2],), rates[1])] if cells[2:] else []),
    )
    parameters = MotionParameters(directions, speeds, sigma, 0.4, walls, 1.0, doors)
    chain, tables = GridChain(grid, parameters), motion_tables(grid, parameters)
    entries, places = tables.location, grid.size + 1
    location = np.zeros((places, len(speeds), directions, places))
    location[entries.cell, entries.speed, entries.direction, entries.next_cell] = entries.probability
    expected = tables.direction[..., None] * location[:, :, None]
    for place, speed, direction in np.ndindex(*expected.shape[:3]):
        outcomes = chain.outcomes(place if place < grid.size else OUTSIDE, direction, speed)
        found = np.zeros(expected.shape[3:])
        for (to_direction, to_place), weight in zip(outcomes.pairs, outcomes.weights, strict=True):
            found[to_direction, to_place] += weight  # OUTSIDE is -1: the last place
        assert np.abs(found - expected[place, speed, direction]).max() < 1e-9


@pytest.mark.example
@pytest.mark.parametrize("kind", [GridTruth, ContinuousTruth])
def test_targets_leave_by_doors_alone_and_come_in_by_them(kind) -> None:
    truth = kind.initial(HALL, PARAMETERS, 120, np.random.default_rng(2))
    assert (truth.cells != OUTSIDE).all()
    near_a_door = np.array([(0, 2), (0, 3), (7, 0)])
    left = entered = 0
    for _ in range(15):
        before, truth = truth, truth.step()
        assert np.array_equal(truth.cells == OUTSIDE, np.isnan(truth.positions_m[:, 0]))
        went = (before.cells != OUTSIDE) & (truth.cells == OUTSIDE)
        came = (before.cells == OUTSIDE) & (truth.cells != OUTSIDE)
        away = np.abs(HALL.cells[before.cells[went]][:, None] - near_a_door).max(axis=2).min(axis=1)
        assert (away <= 2).all()  # no move is longer than 1.5 cells
        assert set(map(tuple, HALL.cells[truth.cells[came]].tolist())) <= set(map(tuple, near_a_door.tolist()))
        left, entered = left + int(went.sum()), entered + int(came.sum())
    assert left > 50
    assert entered > 50


@pytest.mark.example
def test_targets_enter_at_the_doors_rates() -> None:
    truth = GridTruth.initial(HALL, PARAMETERS, 8000, np.random.default_rng(5), np.append(np.zeros(48), 1.0))
    assert (truth.cells == OUTSIDE).all()
    cells = truth.step().cells
    comes = 1 - math.exp(-0.4)
    expected = {(0, 2): comes * 0.375, (0, 3): comes * 0.375, (7, 0): comes * 0.25}
    for (column, row), share in expected.items():
        assert (cells == HALL.number[row, column]).mean() == pytest.approx(share, abs=0.012)
    assert (cells == OUTSIDE).mean() == pytest.approx(1 - comes, abs=0.015)


@pytest.mark.example
@pytest.mark.parametrize("walls", WALLS)
def test_straight_out_of_the_door_and_against_the_wall_beside_it(walls: str) -> None:
    """Heading west at 1.5 m/s: through the door at rows 2 and 3, but not through the wall above."""
    parameters = MotionParameters(8, (1.5,), 0.0, 0.0, walls, 1.0, (DoorParameters(((0, 2), (0, 3)), 0.0),))
    truth = ContinuousTruth.initial(HALL, parameters, 3, np.random.default_rng(0))
    at = np.array([[0.5, 2.5], [1.2, 3.5], [0.5, 5.5]])
    moved = replace(truth, positions_m=at, headings_rad=np.full(3, math.pi)).step()
    assert (moved.cells == OUTSIDE).tolist() == [True, True, False]
    assert (moved.step().cells[:2] == OUTSIDE).all()  # a rate of 0 lets nobody in


@pytest.mark.example
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_percent_obs_is_of_the_targets_present(truth) -> None:
    surveillance = tiny_with_a_door(2, 0.05)
    world, controller = prepared_run(surveillance, "pomdp", 60, 0, 0, truth)
    present, steps = [], []

    def note(step) -> None:
        present.append(int(np.isfinite(world.truth.positions_m[:, 0]).sum()))
        steps.append(step)

    record = run_loop(world, controller, 60, note)
    assert [step.present for step in steps] == present
    assert len(set(present)) > 1
    assert 0 in present  # and such a step does not count
    shares = [100 * step.observed / count for step, count in zip(steps, present, strict=True) if count]
    assert percent_obs(record) == pytest.approx(np.mean(shares))
    assert all(step.observed <= count for step, count in zip(steps, present, strict=True))


@pytest.mark.property
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_all_controllers_run_with_doors_and_none_passes_the_clairvoyant(truth) -> None:
    surveillance = tiny_with_a_door()
    for run in range(2):
        found = {
            name: simulate_run(surveillance, name, 25, 4, run, truth).percent_obs
            for name in CONTROLLERS
            if name != "lookahead"
        }
        assert all(share <= found["clairvoyant"] + 1e-9 for share in found.values())


@pytest.mark.example
def test_on_the_grid_the_model_is_never_surprised() -> None:
    """The first states follow the model's initial belief, outside included, and all later ones its transitions."""
    surveillance = tiny_with_a_door(8)
    assert sum(simulate_run(surveillance, "pomdp", 40, 1, run).restarts for run in range(3)) == 0
