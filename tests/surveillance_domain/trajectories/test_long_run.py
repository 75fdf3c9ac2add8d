"""Where a motion model leaves people after a while."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.model.build import motion_parameters
from surveillance_domain.model.parameters import DoorParameters, MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.trajectories.long_run import cells_after, drawn_to_walls


def strip(cells: int) -> Grid:
    return Grid(np.ones((1, cells), dtype=bool), 1.0)


def marching(**changed: object) -> MotionParameters:
    """Two directions, one cell a step, never a turn."""
    given = {
        "directions": 2,
        "speeds_mps": (1.0,),
        "sigma_direction_deg": 0.0,
        "sigma_speed_mps": 0.0,
        "walls": "reject",
        "step_s": 1.0,
    }
    return MotionParameters(**(given | changed))  # type: ignore[arg-type]


@pytest.mark.example
def test_who_never_turns_is_at_the_ends_after_a_while() -> None:
    # on nine cells, everybody has come to an end after eight steps, half of them to either; who mirrors keeps walking
    assert cells_after(strip(9), marching(walls="stay"), 8) == 1
    assert cells_after(strip(9), marching(walls="stay"), 0) == 5
    assert cells_after(strip(9), marching(walls="reflect"), 8) == 5


@pytest.mark.example
def test_who_left_by_a_door_does_not_count() -> None:
    door = DoorParameters(cells=((8, 0),), rate_per_s=0.0)
    # those who go right leave, those who go left stand at the left end: one cell has them all
    assert cells_after(strip(9), marching(walls="stay", doors=(door,)), 12) == 1


@pytest.mark.example
def test_the_motion_of_a_street_sticks_to_the_walls_of_a_hall_and_its_own_does_not() -> None:
    site = load_site("hall")
    own = motion_parameters(site)
    assert drawn_to_walls(site.grid, own) is None
    street = MotionParameters(8, (0.345, 0.984, 1.376), 8.636, 0.12, "reject", 1.0)
    found = drawn_to_walls(site.grid, street)
    assert found is not None
    assert found[0] <= 4  # the corners
    assert found[1] >= 40
    reflecting = MotionParameters(8, (0.345, 0.984, 1.376), 8.636, 0.12, "reflect", 1.0)
    assert drawn_to_walls(site.grid, reflecting) is None
