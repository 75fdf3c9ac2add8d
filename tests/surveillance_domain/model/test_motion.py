"""The motion tables against a slow twin: scalar loops over every pair (d', l'), paths in exact fractions."""

from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.model.motion import MotionParameters, MotionTables, motion_tables
from surveillance_domain.model.motion_direction import direction_table
from surveillance_domain.model.motion_location import move_shares
from surveillance_domain.site.grid import Grid

WALLS = ("reject", "reflect", "stay")


def parameters(walls: str = "reject", **changes) -> MotionParameters:
    numbers = {
        "directions": 8,
        "speeds_mps": (1.5,),
        "sigma_direction_deg": 15.0,
        "sigma_speed_mps": 0.0,
        "walls": walls,
        "step_s": 1.0,
    }
    return MotionParameters(**{**numbers, **changes})


def joint_law(tables: MotionTables, cells: int) -> np.ndarray:
    """P(d',l'|l,d,v') as ``[l, v', d, d', l']``."""
    speeds, directions = len(tables.speed), tables.direction.shape[-1]
    location = np.zeros((cells, directions, speeds, cells))
    entries = tables.location
    np.add.at(location, (entries.cell, entries.direction, entries.speed, entries.next_cell), entries.probability)
    direction = np.broadcast_to(tables.direction, (cells, speeds, directions, directions))
    return np.einsum("lvde,levn->lvden", direction, location)


# --- the twin --------------------------------------------------------------------------------------------------------


def is_open(grid: Grid, start: tuple[int, int], end: tuple[int, int]) -> bool:
    """Clip the segment between two centres to every cell of the map, and to the corners between them."""

    def free(column: int, row: int) -> bool:
        return 0 <= column < grid.columns and 0 <= row < grid.rows and bool(grid.free[row, column])

    if not free(*end):
        return False
    move = (end[0] - start[0], end[1] - start[1])
    half = Fraction(1, 2)
    for row in range(grid.rows):
        for column in range(grid.columns):
            low, high, apart = Fraction(0), Fraction(1), False
            for way, offset in zip(move, (column - start[0], row - start[1]), strict=True):
                if way == 0:
                    apart |= offset != 0
                else:
                    first, last = sorted([(offset - half) / way, (offset + half) / way])
                    low, high = max(low, first), min(high, last)
            if not apart and low < high and not free(column, row):
                return False
    for row in range(grid.rows - 1):
        for column in range(grid.columns - 1):
            corner = (column + half - start[0], row + half - start[1])
            on_line = corner[0] * move[1] == corner[1] * move[0]
            between = all(min(0, way) < at < max(0, way) for way, at in zip(move, corner, strict=True))
            if on_line and between:
                rising = (move[0] > 0) == (move[1] > 0)
                sides = [(column + 1, row), (column, row + 1)] if rising else [(column, row), (column + 1, row + 1)]
                if not any(free(*side) for side in sides):
                    return False
    return True


def moves_along(grid: Grid, settings: MotionParameters, cell: int, direction: int, speed: int) -> list:
    """``(next cell or None where lost, share)`` of a square moved along a direction."""
    length = settings.speeds_mps[speed] * settings.step_s / grid.cell_m
    angle = 2 * math.pi * direction / settings.directions
    at = [length * math.cos(angle), length * math.sin(angle)]
    column, row = (int(part) for part in grid.cells[cell])
    moves = []
    for dx in range(math.floor(at[0]) - 1, math.ceil(at[0]) + 2):
        for dy in range(math.floor(at[1]) - 1, math.ceil(at[1]) + 2):
            share = max(0.0, 1 - abs(at[0] - dx)) * max(0.0, 1 - abs(at[1] - dy))
            if share > 1e-9:
                target = (column + dx, row + dy)
                arrives = is_open(grid, (column, row), target)
                moves.append((int(grid.number[target[1], target[0]]) if arrives else None, share))
    return moves


def circle_distance(one: float, other: float, directions: int) -> float:
    return min((one - other) % directions, (other - one) % directions)


def twin(grid: Grid, settings: MotionParameters, cell: int, direction: int, speed: int) -> dict:
    """The law of (d', l') for one (l, d, v'), by enumeration."""
    directions = settings.directions
    plain = direction_table(directions, settings.sigma_direction_deg)[direction]
    moves = {d: moves_along(grid, settings, cell, d, speed) for d in range(directions)}
    opened = {d: [(to, share) for to, share in moves[d] if to is not None] for d in moves}
    law: dict = {}

    def put(to_direction: int, to_cell: int, mass: float) -> None:
        law[to_direction, to_cell] = law.get((to_direction, to_cell), 0.0) + mass

    def share_out(chosen: list[int], mass: float) -> None:
        total = sum(share for d in chosen for _, share in opened[d])
        for d in chosen:
            for to, share in opened[d]:
                put(d, to, mass * share / total)

    if settings.walls == "stay":
        for d in range(directions):
            for to, share in moves[d]:
                put(d, cell if to is None else to, plain[d] * share)
    elif settings.walls == "reject":
        total = sum(plain[d] * share for d in opened for _, share in opened[d])
        candidates = [d for d in opened if opened[d]]
        if total >= 1e-12:
            for d in opened:
                for to, share in opened[d]:
                    put(d, to, plain[d] * share / total)
        elif candidates:
            least = min(circle_distance(d, direction, directions) for d in candidates)
            share_out([d for d in candidates if circle_distance(d, direction, directions) == least], 1.0)
        else:
            put(direction, cell, 1.0)
    else:
        for drawn in range(directions):
            leads = {d: any(to != cell for to, _ in opened[d]) for d in opened}
            elsewhere = len(moves[drawn]) > 1 or moves[drawn][0][0] != cell
            if leads[drawn] or not elsewhere:
                share_out([drawn], plain[drawn])
                continue
            images = [-drawn, directions / 2 - drawn, directions / 2 + drawn]
            candidates = [
                d for d in opened if leads[d] and any(circle_distance(d, i, directions) <= 0.5 for i in images)
            ]
            if candidates:
                least = min(circle_distance(d, drawn, directions) for d in candidates)
                share_out([d for d in candidates if circle_distance(d, drawn, directions) == least], plain[drawn])
            else:
                put(drawn, cell, plain[drawn])
    return law


maps = st.integers(1, 5).flatmap(
    lambda columns: st.lists(
        st.lists(st.sampled_from([True, True, False]), min_size=columns, max_size=columns), min_size=1, max_size=5
    )
)


@pytest.mark.property
@settings(max_examples=40)
@given(
    maps.filter(lambda rows: any(any(row) for row in rows)),
    st.sampled_from(WALLS),
    st.integers(1, 9),
    st.sampled_from([(1.5,), (0.0, 1.0), (0.4, 2.3), (3.0,), (0.7,)]),
    st.sampled_from([0.0, 10.0, 15.0, 40.0]),
)
def test_tables_are_what_enumeration_finds(rows, walls, directions, speeds, sigma):
    grid = Grid(np.array(rows), cell_m=1.0)
    settings = parameters(walls, directions=directions, speeds_mps=speeds, sigma_direction_deg=sigma)
    tables = motion_tables(grid, settings)
    found = joint_law(tables, grid.size)
    assert np.abs(found.sum(axis=(3, 4)) - 1).max() < 1e-12
    for cell, speed, direction in np.ndindex(*found.shape[:3]):
        expected = np.zeros(found.shape[3:])
        for (to_direction, to_cell), mass in twin(grid, settings, cell, direction, speed).items():
            expected[to_direction, to_cell] = mass
        assert np.abs(found[cell, speed, direction] - expected).max() < 1e-9


@pytest.mark.property
@settings(max_examples=40)
@given(maps.filter(lambda rows: any(any(row) for row in rows)), st.sampled_from(WALLS), st.floats(0.0, 4.0))
def test_every_row_sums_to_one_and_entries_are_in_order(rows, walls, speed):
    grid = Grid(np.array(rows), cell_m=0.8)
    tables = motion_tables(grid, parameters(walls, speeds_mps=(speed, speed + 1), sigma_speed_mps=0.3))
    entries = tables.location
    row = (entries.cell * 8 + entries.direction) * 2 + entries.speed
    assert np.abs(np.bincount(row, entries.probability, minlength=grid.size * 16) - 1).max() < 1e-12
    assert (np.diff(row * grid.size + entries.next_cell) > 0).all()
    assert (entries.probability > 0).all()
    assert np.abs(tables.direction.sum(axis=-1) - 1).max() < 1e-12
    assert np.abs(tables.speed.sum(axis=-1) - 1).max() < 1e-12


@pytest.mark.example
def test_half_and_half_along_an_axis():
    moves = move_shares(1.5, 0.0)
    assert dict(zip(moves.offsets, moves.shares, strict=True)) == {(1, 0): 0.5, (2, 0): 0.5}


@pytest.mark.example
def test_shares_along_a_diagonal():
    moves = move_shares(1.5, 45.0)
    assert {offset: round(share, 3) for offset, share in zip(moves.offsets, moves.shares, strict=True)} == {
        (1, 1): 0.882,
        (2, 1): 0.057,
        (1, 2): 0.057,
        (2, 2): 0.004,
    }


@pytest.mark.property
@given(st.floats(0.0, 6.0), st.integers(3, 16), st.integers(0, 15))
def test_the_mean_move_is_exact_and_shares_are_areas(length, directions, direction):
    heading = 360.0 * direction / directions
    moves = move_shares(length, heading)
    mean = np.array(moves.shares) @ np.array(moves.offsets)
    exact = length * np.array([math.cos(math.radians(heading)), math.sin(math.radians(heading))])
    assert np.abs(mean - exact).max() < 2e-9
    assert sum(moves.shares) == pytest.approx(1.0, abs=1e-12)
    grains = (np.arange(200) + 0.5) / 200 - 0.5
    x, y = np.meshgrid(grains + exact[0], grains + exact[1])
    for (dx, dy), share in zip(moves.offsets, moves.shares, strict=True):
        sampled = np.mean((np.abs(x - dx) < 0.5) & (np.abs(y - dy) < 0.5))
        assert share == pytest.approx(sampled, abs=0.012)


@pytest.mark.example
@pytest.mark.parametrize("walls", WALLS)
def test_mean_displacement_in_open_space(walls):
    grid = Grid(np.ones((9, 9), dtype=bool), cell_m=0.5)
    settings = parameters(walls, speeds_mps=(0.9,), step_s=0.8)
    entries = motion_tables(grid, settings).location
    centre = int(grid.number[4, 4])
    for direction in range(8):
        chosen = (entries.cell == centre) & (entries.direction == direction)
        moved = grid.centres_m[entries.next_cell[chosen]] - grid.centres_m[centre]
        angle = math.radians(45.0 * direction)
        expected = 0.72 * np.array([math.cos(angle), math.sin(angle)])
        assert entries.probability[chosen] @ moved == pytest.approx(expected, abs=1e-12)


@pytest.mark.example
def test_rejected_before_a_wall_by_hand():
    """On one row of three cells at 1.5 cells a step only +1 is open from the middle, and nothing from it crosswise."""
    grid = Grid.from_rows(["..."], cell_m=1.0)
    law = joint_law(motion_tables(grid, parameters("reject", directions=4)), grid.size)
    assert law[1, 0, 0, 0, 2] == pytest.approx(1.0, abs=1e-12)
    assert law[2, 0, 0, 2, [0, 1]] == pytest.approx([0.5, 0.5], abs=1e-12)
    crosswise = law[1, 0, 1]
    assert crosswise[0, 2] == pytest.approx(0.5, abs=1e-12)
    assert crosswise[2, 0] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.example
def test_all_directions_in_reach_blocked_nearest_ones_share():
    """Facing up in a corner pocket that is open only to the right: the turn to the right takes all."""
    grid = Grid.from_rows(["...", "##."], cell_m=1.0)
    cell = int(grid.number[1, 0])
    law = joint_law(motion_tables(grid, parameters("reject", sigma_direction_deg=0.0)), grid.size)
    assert law[cell, 0, 2, 0].sum() == pytest.approx(1.0, abs=1e-12)
    assert law[cell, 0, 3, 0].sum() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.example
@pytest.mark.parametrize("walls", WALLS)
def test_a_cell_without_open_moves_keeps_place_and_direction(walls):
    grid = Grid.from_rows(["###", "#.#", "###"], cell_m=1.0)
    law = joint_law(motion_tables(grid, parameters(walls, sigma_direction_deg=0.0)), grid.size)
    assert np.array_equal(law[0, 0, :, :, 0], np.eye(8))


@pytest.mark.example
def test_mirrored_on_one_wall_and_in_a_corner():
    grid = Grid(np.ones((5, 5), dtype=bool), cell_m=1.0)
    tables = motion_tables(grid, parameters("reflect", sigma_direction_deg=0.0))
    right_wall, corner = int(grid.number[2, 4]), int(grid.number[4, 4])
    assert tables.direction[right_wall, 0, 0, 4] == 1.0
    assert tables.direction[right_wall, 0, 1, 3] == 1.0
    assert tables.direction[right_wall, 0, 7, 5] == 1.0
    assert tables.direction[right_wall, 0, 2, 2] == 1.0
    assert tables.direction[corner, 0, 1, 5] == 1.0
    assert tables.direction[corner, 0, 2, 6] == 1.0


@pytest.mark.example
def test_mirrored_to_both_bins_when_midway_between_them():
    """Of five directions none lies opposite to 0: its mirror lies midway between 144 and 216 degrees."""
    grid = Grid(np.ones((5, 5), dtype=bool), cell_m=1.0)
    tables = motion_tables(grid, parameters("reflect", directions=5, sigma_direction_deg=0.0))
    assert tables.direction[int(grid.number[2, 4]), 0, 0] == pytest.approx([0, 0, 0.5, 0.5, 0], abs=1e-9)


@pytest.mark.example
def test_staying_takes_the_blocked_half_only():
    grid = Grid.from_rows(["..."], cell_m=1.0)
    tables = motion_tables(grid, parameters("stay"))
    assert tables.direction_scope == "direction"
    assert tables.direction.shape == (8, 8)
    entries = tables.location
    chosen = (entries.cell == 1) & (entries.direction == 0)
    assert entries.next_cell[chosen].tolist() == [1, 2]
    assert entries.probability[chosen].tolist() == [0.5, 0.5]


@pytest.mark.example
def test_speed_zero_stays_and_turns_freely():
    grid = Grid.from_rows(["#.#"], cell_m=1.0)
    law = joint_law(motion_tables(grid, parameters("reject", speeds_mps=(0.0,))), grid.size)
    assert law[0, 0, :, :, 0] == pytest.approx(direction_table(8, 15.0), abs=1e-12)


@pytest.mark.example
def test_a_grid_without_free_cells_is_refused():
    with pytest.raises(ValueError, match="no free cell"):
        motion_tables(Grid(np.zeros((2, 2), dtype=bool), cell_m=1.0), parameters())


@pytest.mark.example
def test_all_wrong_numbers_are_named_at_once():
    with pytest.raises(ValueError, match="directions is 0") as error:
        parameters(directions=0, speeds_mps=(1.0, 1.0), sigma_speed_mps=float("nan"), step_s=0.0)
    for part in ("twice", "sigma_speed_mps is nan", "step_s is 0.0"):
        assert part in str(error.value)


@pytest.mark.example
def test_an_unknown_wall_variant_is_refused():
    with pytest.raises((ValueError, TypeError), match="reject"):
        parameters("bounce")


@pytest.mark.example
def test_a_hundred_thousand_cells_take_entries_in_proportion():
    """Nothing is quadratic in cells: entries and direction rows grow with the cells alone."""
    free = np.random.default_rng(5).random((400, 330)) < 0.77
    grid = Grid(free, cell_m=1.0)
    tables = motion_tables(grid, parameters("reject"))
    assert grid.size > 100_000
    assert tables.direction.shape == (grid.size, 1, 8, 8)
    assert len(tables.location.probability) <= grid.size * 8 * 4
