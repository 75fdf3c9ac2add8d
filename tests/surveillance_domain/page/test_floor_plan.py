"""What the map of the page draws."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from surveillance_domain.page.floor_plan import heat_of, runs_m
from surveillance_domain.page.palette import camera_colour, heat_palette
from surveillance_domain.site.grid import Grid

WALLED = Grid.from_rows(["..#", "...", "#.."], cell_m=0.5, origin_m=(1.0, 2.0))


@pytest.mark.example
def test_heat_is_summed_over_targets_and_has_holes_where_walls_are() -> None:
    belief = np.zeros((2, 7), dtype=np.float32)
    belief[0, 0], belief[1, 0], belief[1, 6] = 1.0, 0.25, 0.75
    heat = heat_of(belief, WALLED)
    assert heat[0].tolist()[1:] == [1.25, 0.0]
    assert heat[2].tolist()[:2] == [0.0, 0.75]
    assert np.argwhere(np.isnan(heat)).tolist() == [[0, 0], [2, 2]]
    assert np.nansum(heat_of(None, WALLED)) == 0


@pytest.mark.example
def test_runs_join_neighbours_in_a_row() -> None:
    member = np.array([[True, True, False], [True, False, True], [False, False, False]])
    assert runs_m(WALLED, member).tolist() == [
        [1.0, 2.0, 2.0, 2.5],
        [1.0, 1.5, 2.5, 3.0],
        [2.0, 2.5, 2.5, 3.0],
    ]


@pytest.mark.property
@given(arrays(bool, st.tuples(st.integers(1, 6), st.integers(1, 6))))
def test_runs_cover_the_set_and_nothing_else(member: np.ndarray) -> None:
    grid = Grid(np.ones_like(member), 1.0)
    covered = np.zeros(member.shape, dtype=int)
    for left, right, bottom, top in runs_m(grid, member).astype(int).tolist():
        covered[bottom:top, left:right] += 1
    assert np.array_equal(covered, member.astype(int))


@pytest.mark.example
def test_heat_darkens_with_the_square_root() -> None:
    palette = heat_palette(10)
    assert (palette[0], palette[1], palette[4], palette[9]) == ("#ffffff", "#cbb8e0", "#8a63b5", "#3f1d6b")


@pytest.mark.example
def test_colours_of_cameras_come_again_after_the_sixth() -> None:
    assert camera_colour(7) == camera_colour(1) != camera_colour(0)
