"""The prior over the cells of a site: counts of hand-placed positions, and half a visit where people can walk."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.prior import cells_of_half, placed_prior
from surveillance_domain.trajectories.staging import Placement

ROOM = Grid.from_rows(["..#.", "..#."], 1.0)  # free cells 0, 1, 2 | 3, 4, 5: the last of each row is walled off


@pytest.mark.example
def test_visits_and_half_a_visit_more_where_people_can_walk() -> None:
    points = np.array([[0.5, 0.5], [0.6, 0.5], [1.5, 1.5]])
    prior = placed_prior(points, ROOM, Placement())
    assert (prior.probability * 5).tolist() == pytest.approx([2.5, 0.5, 0, 0.5, 1.5, 0])
    assert (prior.points, prior.off_map, prior.in_walls, prior.out_of_reach) == (3, 0, 0, 2)


@pytest.mark.example
def test_cells_that_meet_at_a_corner_only_are_apart() -> None:
    corner = Grid.from_rows([".#", "#."], 1.0)
    assert placed_prior(np.array([[0.5, 1.5]]), corner, Placement()).probability.tolist() == [0, 1]


@pytest.mark.example
def test_positions_are_turned_and_moved_into_the_site() -> None:
    placement = Placement((1.0, 0.0), 90.0)  # (x, y) becomes (1 - y, x)
    prior = placed_prior(np.array([[0.5, 0.5], [0.5, 9.0], [0.5, -1.2]]), ROOM, placement)
    assert (prior.points, prior.off_map, prior.moved_out_of_walls) == (2, 1, 1)
    # (0.5, 0.5) is in the cell [0, 0]; (2.2, 0.5), in the wall, goes to the nearest free place, in [1, 0]
    assert (prior.probability * 4).tolist() == pytest.approx([1.5, 1.5, 0, 0.5, 0.5, 0])


@pytest.mark.example
def test_nobody_on_the_map_is_refused() -> None:
    with pytest.raises(ValueError, match=r"people are between \(50.0, 50.0\).*give --offset-m"):
        placed_prior(np.array([[50.0, 50.0]]), ROOM, Placement())


@pytest.mark.example
@pytest.mark.parametrize(("weights", "cells"), [([4, 1, 1], 1), ([1, 1, 1, 1], 2), ([1, 1, 1], 2)])
def test_cells_that_hold_half(weights: list[float], cells: int) -> None:
    assert cells_of_half(np.array(weights, dtype=float)) == cells
