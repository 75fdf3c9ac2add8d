"""Line of sight: drawn cases, and exact geometry in fractions as the slow twin."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from surveillance_domain.model.line_of_sight import line_of_sight
from surveillance_domain.site.grid import Grid

Point = tuple[Fraction, Fraction]


def picture(rows: list[str], position: tuple[float, float]) -> list[str]:
    """The map with ``o`` where a free cell is seen."""
    grid = Grid.from_rows(rows, 1.0)
    marks = np.full(grid.free.shape, "#")
    marks[grid.free] = np.where(line_of_sight(grid, np.array(position), grid.centres_m), "o", ".")
    return ["".join(row) for row in marks[::-1]]


def inside_span(start: Point, end: Point, column: int, row: int) -> bool:
    """Whether the segment crosses the open inside of a cell (Liang-Barsky, in fractions)."""
    low, high = Fraction(0), Fraction(1)
    for axis, edge in ((0, column), (1, row)):
        travel = end[axis] - start[axis]
        if travel == 0:
            if not edge < start[axis] < edge + 1:
                return False
            continue
        enter, leave = sorted(((edge - start[axis]) / travel, (edge + 1 - start[axis]) / travel))
        low, high = max(low, enter), min(high, leave)
    return low < high


def sees(free: np.ndarray, start: Point, end: Point) -> bool:
    """The rule itself: no blocked cell's inside on the way, no corner between two blocked cells."""
    rows, columns = free.shape

    def blocked(column: int, row: int) -> bool:
        return 0 <= column < columns and 0 <= row < rows and not free[row, column]

    for row, column in product(range(rows), range(columns)):
        if blocked(column, row) and inside_span(start, end, column, row):
            return False
    travel = (end[0] - start[0], end[1] - start[1])
    for corner in product(range(columns + 1), range(rows + 1)):
        offset = (corner[0] - start[0], corner[1] - start[1])
        if offset[0] * travel[1] != offset[1] * travel[0] or 0 in travel:
            continue
        if 0 < offset[0] / travel[0] < 1:
            up_right = (travel[0] > 0) == (travel[1] > 0)
            beside = ((-1, 0), (0, -1)) if up_right else ((-1, -1), (0, 0))
            if all(blocked(corner[0] + dx, corner[1] + dy) for dx, dy in beside):
                return False
    return True


@pytest.mark.property
@given(
    free=arrays.arrays(np.bool_, st.tuples(st.integers(1, 7), st.integers(1, 7)), elements=st.booleans()),
    eighths=st.tuples(st.integers(-16, 72), st.integers(-16, 72)),
)
def test_it_agrees_with_exact_geometry_on_random_maps(free: np.ndarray, eighths: tuple[int, int]) -> None:
    grid = Grid(free, 1.0)
    seen = line_of_sight(grid, np.array(eighths) / 8, grid.centres_m)
    start = (Fraction(eighths[0], 8), Fraction(eighths[1], 8))
    for (column, row), found in zip(grid.cells.tolist(), seen.tolist(), strict=True):
        end = (Fraction(2 * column + 1, 2), Fraction(2 * row + 1, 2))
        assert found == sees(free, start, end)


@pytest.mark.property
@given(
    free=arrays.arrays(np.bool_, (6, 6), elements=st.booleans()),
    cell_m=st.sampled_from([0.1, 0.3, 0.5, 1.7]),
    origin=st.tuples(st.integers(-30, 30), st.integers(-30, 30)),
    quarters=st.tuples(st.integers(-4, 28), st.integers(-4, 28)),
)
def test_it_does_not_depend_on_where_the_map_lies_or_how_large_its_cells_are(
    free: np.ndarray, cell_m: float, origin: tuple[int, int], quarters: tuple[int, int]
) -> None:
    unit, moved = Grid(free, 1.0), Grid(free, cell_m, (origin[0] / 10, origin[1] / 10))
    position = np.array(quarters) / 4
    there = position * cell_m + np.array(moved.origin_m)
    expected = line_of_sight(unit, position, unit.centres_m)
    assert np.array_equal(line_of_sight(moved, there, moved.centres_m), expected)


@pytest.mark.example
def test_a_pillar_casts_a_shadow() -> None:
    rows = [
        ".....",
        ".....",
        "..#..",
        ".....",
        ".....",
    ]
    assert picture(rows, (2.5, 0.0)) == [
        "o...o",
        "oo.oo",
        "oo#oo",
        "ooooo",
        "ooooo",
    ]


@pytest.mark.example
def test_nobody_looks_between_two_blocked_cells_that_touch() -> None:
    assert picture([".#", "#."], (1.5, 0.5)) == [".#", "#o"]
    assert picture([".#", ".."], (1.5, 0.5)) == ["o#", "oo"]


@pytest.mark.example
def test_a_camera_on_a_wall_sees_its_own_side_only() -> None:
    rows = ["...", "###", "..."]
    assert picture(rows, (1.5, 1.0)) == ["...", "###", "ooo"]
    assert picture(rows, (1.5, 2.0)) == ["ooo", "###", "..."]


@pytest.mark.example
def test_a_camera_on_a_corner_of_a_building_sees_round_it() -> None:
    rows = ["....", "....", "##..", "##.."]
    assert picture(rows, (2.0, 2.0)) == ["oooo", "oooo", "##oo", "##oo"]


@pytest.mark.example
def test_a_camera_in_a_niche_sees_out_of_it() -> None:
    rows = [".#.", "#..", "..."]
    assert picture(rows, (1.0, 2.0)) == ["o#.", "#oo", ".oo"]


@pytest.mark.example
def test_outside_of_the_map_nothing_blocks() -> None:
    assert picture(["..", "#."], (-3.0, 1.5)) == ["oo", "#."]
    assert picture(["..", "#."], (-3.0, 0.5)) == ["oo", "#."]


@pytest.mark.example
def test_straight_above_a_cell_it_is_seen() -> None:
    assert picture(["#.", "##"], (1.5, 1.5)) == ["#o", "##"]
