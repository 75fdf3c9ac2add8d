"""Doors: moves out of them, ways in, how long a visit lasts, and the whole model against the exponential solver."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.verification import verify
from surveillance_domain.model.build import OUTSIDE, motion_parameters, surveillance_model
from surveillance_domain.model.motion import motion_tables
from surveillance_domain.model.motion_doors import leaves_by_door
from surveillance_domain.model.parameters import DoorParameters, MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Door
from surveillance_domain.site.site import Site

WALLS = ("reject", "reflect", "stay")
ROW = Grid.from_rows(["..."], cell_m=1.0)


def parameters(doors: list[DoorParameters], **changes: object) -> MotionParameters:
    """East, north, west, south at one cell a step, never turning."""
    plain = MotionParameters(4, (1.0,), 0.0, 0.0, "reject", 1.0, tuple(doors))
    return replace(plain, **changes)


def location(grid: Grid, numbers: MotionParameters) -> np.ndarray:
    """P(l'|l,d',v') at the first speed as ``[l, d', l']``, outside last."""
    table = motion_tables(grid, numbers).location
    dense = np.zeros((grid.size + 1, numbers.directions, grid.size + 1))
    first = table.speed == 0
    dense[table.cell[first], table.direction[first], table.next_cell[first]] = table.probability[first]
    return dense


def with_doors(site: Site, doors: list[Door], **changes: object) -> Site:
    return replace(site, targets=site.targets.model_copy(update={"doors": tuple(doors), **changes}))


@pytest.mark.example
def test_who_leaves_by_a_door() -> None:
    grid = Grid.from_rows(["....", "..#.", "...."], cell_m=1.0)
    door = [DoorParameters(((3, 1), (1, 0)), 0.1)]

    def cells(dx: int, dy: int) -> list[tuple[int, int]]:
        return [tuple(cell) for cell in grid.cells[leaves_by_door(grid, door, dx, dy)].tolist()]

    assert cells(1, 0) == [(3, 1)]
    assert cells(0, -1) == [(1, 0)]
    assert cells(1, 1) == [(3, 1)]  # aslant, but the door is the last cell on the map
    assert cells(0, -2) == [(1, 0), (1, 1)]
    assert cells(2, 0) == [(3, 1)]  # from (2, 1) one would come, but that is blocked
    assert cells(3, 0) == [(3, 1)]  # (1, 1) is behind the block
    assert cells(-1, 0) == []
    assert cells(0, 0) == []
    assert cells(9, 0) == [(3, 1)]


@pytest.mark.example
def test_a_row_of_three_cells_with_a_door_at_its_end() -> None:
    """At a rate of ln 2 a second half of those who are outside come in, within a second, and go west."""
    numbers = parameters([DoorParameters(((2, 0),), math.log(2))])
    tables = motion_tables(ROW, numbers)
    law = location(ROW, numbers)
    assert law[2, 0].tolist() == [0, 0, 0, 1]  # east from the door: out
    assert law[1, 0].tolist() == [0, 0, 1, 0]
    assert law[3, 2].tolist() == pytest.approx([0, 0, 0.5, 0.5])  # in, heading west
    assert law[3, 0].tolist() == [0, 0, 0, 1]  # never heading east
    assert tables.direction[3, 0].tolist() == [[0, 0, 1, 0]] * 4
    assert np.allclose(law.sum(axis=2), 1)


@pytest.mark.example
def test_doors_share_who_comes_in_by_their_rates_and_their_cells_evenly() -> None:
    grid = Grid.from_rows(["....", "...."], cell_m=1.0)
    doors = [DoorParameters(((0, 0), (0, 1)), 0.2), DoorParameters(((3, 1),), 0.6)]
    tables = motion_tables(grid, parameters(doors, step_s=2.0))
    entries = tables.location
    joint = np.zeros(grid.size + 1)
    came = entries.cell == grid.size
    weight = tables.direction[grid.size, 0, 0][entries.direction[came]] * entries.probability[came]
    np.add.at(joint, entries.next_cell[came], weight)
    comes = 1 - math.exp(-0.8 * 2)
    expected = np.zeros(grid.size + 1)
    expected[[grid.number[0, 0], grid.number[1, 0]]] = comes * 0.25 / 2
    expected[grid.number[1, 3]] = comes * 0.75
    expected[-1] = 1 - comes
    assert joint == pytest.approx(expected)


@pytest.mark.example
def test_the_long_run_share_outside() -> None:
    """Who comes in at the end of a row of three, walks west, turns round at the wall: 3 cells in, 2 more out, 5 steps.

    Entering takes 1/p steps on average, so the share outside is (1/p) / (1/p + 5), with p = 1/2: 2/7.
    """
    tables = motion_tables(ROW, parameters([DoorParameters(((2, 0),), math.log(2))], walls="reflect"))
    assert tables.outside_share == pytest.approx(2 / 7, abs=1e-6)


@pytest.mark.example
def test_doors_that_let_nobody_out_or_in() -> None:
    nobody_in = motion_tables(ROW, parameters([DoorParameters(((2, 0),), 0.0)], walls="reflect"))
    assert nobody_in.outside_share == 0
    nobody_out = motion_tables(ROW, parameters([DoorParameters(((1, 0),), 0.5)], directions=2))  # a door in the middle
    assert nobody_out.outside_share == 0


@pytest.mark.property
@settings(max_examples=20)
@given(
    st.lists(st.lists(st.sampled_from([True, True, False]), min_size=3, max_size=3), min_size=1, max_size=4),
    st.sampled_from(WALLS),
    st.integers(1, 6),
    st.sampled_from([(1.5,), (1.0,), (2.3, 0.4)]),
    st.data(),
)
def test_tables_with_doors_are_distributions_and_stationary(rows, walls, directions, speeds, data) -> None:
    grid = Grid(np.array(rows), cell_m=1.0)
    if grid.size == 0:
        return
    cells = [tuple(cell) for cell in grid.cells.tolist()]
    chosen = data.draw(st.lists(st.sampled_from(cells), min_size=1, max_size=3, unique=True))
    doors = (DoorParameters(tuple(chosen), data.draw(st.sampled_from([0.1, 2.0]))),)
    tables = motion_tables(grid, MotionParameters(directions, speeds, 40.0, 0.4, walls, 1.0, doors))
    entries, places = tables.location, grid.size + 1
    assert tables.direction.shape[0] == places
    assert np.abs(tables.direction.sum(axis=-1) - 1).max() < 1e-12
    keys = (entries.cell * directions + entries.direction) * len(speeds) + entries.speed
    sums = np.bincount(keys, weights=entries.probability)
    assert sums == pytest.approx(np.ones(places * directions * len(speeds)))
    assert len(np.unique(keys * places + entries.next_cell)) == len(keys)
    # the share outside, against the stationary distribution of the whole chain
    size = places * directions * len(speeds)
    chain = np.zeros((places, directions, len(speeds), places, directions, len(speeds)))
    fields = (entries.cell, entries.direction, entries.speed, entries.next_cell, entries.probability)
    for place, taken, pace, after, probability in zip(*fields, strict=True):
        turned = tables.direction[place, pace, :, taken][:, None] * tables.speed[None, :, pace]
        chain[place, :, :, after, taken, pace] += probability * turned
    square = chain.reshape(size, size)
    assert square.sum(axis=1) == pytest.approx(np.ones(size))
    if len(speeds) > 1:  # the slow stay longer and so begin fewer visits, which the share leaves out
        return
    start = np.zeros((places, directions, len(speeds)))
    start[-1] = 1 / (directions * len(speeds))
    here, total, steps = start.ravel(), 0.0, 1000
    for _ in range(steps):
        total += here.reshape(start.shape)[-1].sum()
        here = here @ square
    assert tables.outside_share == pytest.approx(total / steps, abs=0.03)


@pytest.mark.property
@pytest.mark.parametrize("walls", WALLS)
@pytest.mark.parametrize(("detection", "noise"), [(1.0, 0.0), (0.7, 0.5)])
def test_on_micro_with_doors_the_model_decomposes_and_the_exponential_solver_agrees(
    walls: str, detection: float, noise: float
) -> None:
    doors = [Door(cells=((0, 0),), rate_per_s=0.3), Door(cells=((1, 1),), rate_per_s=0.1)]
    site = with_doors(load_site("micro").with_overrides(detection, noise), doors, walls=walls)
    model = surveillance_model(site, 2).model
    assert fp.decompose(model).decomposes
    found = verify(model, 4, 6, np.random.default_rng(1))
    assert found.holds, found.first_difference
    assert found.actions_agree == 1


@pytest.mark.example
def test_the_model_of_a_site_with_a_door() -> None:
    site = with_doors(load_site("tiny"), [Door(cells=((0, 0),), rate_per_s=0.2)])
    built = surveillance_model(site, 1)
    place = built.model.variable("target1.location")
    assert place.values[-1] == OUTSIDE
    assert place.size == 21
    assert built.model.variable("target1.sighting").size == 21  # 20 cells and unseen: who is outside is not seen
    seen = built.model.observation["target1.sighting"].condition({"target1.location.next": OUTSIDE})
    presets = {f"{camera.name}.preset.next": camera.presets[1].name for camera in site.cameras}
    assert seen.condition(presets).dense().array.tolist() == [0] * 20 + [1]
    start = built.model.initial["target1.location"].dense().array
    assert start.sum() == pytest.approx(1)
    assert start[-1] == motion_tables(site.grid, motion_parameters(site)).outside_share
    assert np.ptp(start[:-1]) == 0


@pytest.mark.example
def test_without_doors_nothing_is_outside() -> None:
    built = surveillance_model(load_site("tiny"), 1)
    assert built.model.variable("target1.location").size == 20
    assert motion_tables(built.site.grid, motion_parameters(built.site)).outside_share is None
