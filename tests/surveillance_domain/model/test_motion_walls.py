"""Paths between cells against slab clipping in exact fractions, and the maps they are laid over."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.model.motion_walls import open_moves, path_of

HALF = Fraction(1, 2)


def meets(dx: int, dy: int, cell: tuple[int, int], closed: bool) -> bool:
    """Does the segment from (0, 0) to (dx, dy) meet the open (or closed) unit square about a cell's centre?"""
    low, high = Fraction(0), Fraction(1)
    for move, centre in ((dx, cell[0]), (dy, cell[1])):
        if move == 0:
            if not (abs(centre) <= HALF if closed else abs(centre) < HALF):
                return False
            continue
        ends = sorted([(centre - HALF) / move, (centre + HALF) / move])
        low, high = max(low, ends[0]), min(high, ends[1])
    return low <= high if closed else low < high


def brute_path(dx: int, dy: int) -> tuple[set, set]:
    box = list(product(range(min(0, dx) - 1, max(0, dx) + 2), range(min(0, dy) - 1, max(0, dy) + 2)))
    entered = {cell for cell in box if meets(dx, dy, cell, closed=False)}
    touched = {cell for cell in box if meets(dx, dy, cell, closed=True)} - entered
    return entered, touched


@pytest.mark.example
def test_path_of_a_knights_move_enters_both_middle_cells():
    assert path_of(2, 1).cells == ((1, 0), (1, 1), (2, 1))
    assert path_of(2, 1).corners == ()


@pytest.mark.example
def test_a_diagonal_passes_one_corner_a_cell():
    path = path_of(-2, 2)
    assert path.cells == ((-1, 1), (-2, 2))
    assert path.corners == (((-1, 0), (0, 1)), ((-2, 1), (-1, 2)))


@pytest.mark.example
@pytest.mark.parametrize(("dx", "dy"), list(product(range(-6, 7), range(-6, 7))))
def test_path_is_what_exact_clipping_finds(dx, dy):
    path = path_of(dx, dy)
    entered, touched = brute_path(dx, dy)
    assert {(0, 0), *path.cells} == entered
    assert len(set(path.cells)) == len(path.cells)
    assert {cell for pair in path.corners for cell in pair} == touched
    for (one_x, one_y), (other_x, other_y) in path.corners:
        assert abs(one_x - other_x) == 1
        assert abs(one_y - other_y) == 1


@pytest.mark.example
def test_one_blocked_side_of_a_corner_lets_pass_and_two_do_not():
    free = np.ones((2, 2), dtype=bool)
    free[0, 1] = False
    assert open_moves(free, 1, 1)[0, 0]
    free[1, 0] = False
    assert not open_moves(free, 1, 1)[0, 0]


@pytest.mark.example
def test_a_move_longer_than_the_map_is_never_open():
    assert not open_moves(np.ones((2, 3), dtype=bool), 3, 0).any()
    assert not open_moves(np.ones((2, 3), dtype=bool), 0, -2).any()
    assert open_moves(np.ones((2, 3), dtype=bool), -2, 1).sum() == 1


@pytest.mark.property
@given(
    st.integers(1, 5).flatmap(
        lambda columns: st.lists(st.lists(st.booleans(), min_size=columns, max_size=columns), min_size=1, max_size=5)
    ),
    st.integers(-4, 4),
    st.integers(-4, 4),
)
def test_open_moves_cell_by_cell(rows, dx, dy):
    free = np.array(rows)
    entered, touched = brute_path(dx, dy)

    def is_free(column: int, row: int) -> bool:
        return 0 <= row < free.shape[0] and 0 <= column < free.shape[1] and bool(free[row, column])

    found = open_moves(free, dx, dy)
    for row, column in np.ndindex(*free.shape):
        blocked = [cell for cell in touched if not is_free(column + cell[0], row + cell[1])]
        slips = any(are_sides_of_one_corner(dx, dy, one, other) for one, other in product(blocked, repeat=2))
        expected = all(is_free(column + cell[0], row + cell[1]) for cell in entered) and not slips
        assert found[row, column] == expected


def are_sides_of_one_corner(dx: int, dy: int, one: tuple[int, int], other: tuple[int, int]) -> bool:
    """Whether two cells are diagonal neighbours whose common corner lies on the line from (0, 0) to (dx, dy)."""
    diagonal = abs(one[0] - other[0]) == 1 and abs(one[1] - other[1]) == 1
    return diagonal and dx * (one[1] + other[1]) == dy * (one[0] + other[0])
