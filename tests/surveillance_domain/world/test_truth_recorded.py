"""Recorded people as the truth: where they are, where they are heading, when they are not there."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.truth import OUTSIDE, Truth
from surveillance_domain.world.truth_recorded import RecordedTruth

HALL = Grid(np.ones((4, 6), dtype=bool), cell_m=1.0)
PARAMETERS = MotionParameters(4, (0.0, 1.0), 10.0, 0.1, "reject", 1.0)
NAN = (np.nan, np.nan)


@pytest.mark.example
def test_a_person_who_enters_turns_stands_and_leaves() -> None:
    path = np.array([[NAN], [(0.5, 0.5)], [(1.5, 0.5)], [(1.5, 1.6)], [(1.5, 1.6)], [NAN]])
    truth = RecordedTruth(path, HALL, PARAMETERS)
    assert isinstance(truth, Truth)
    found = []
    for _ in range(7):
        found.append((int(truth.cells[0]), int(truth.directions[0]), int(truth.speeds[0])))
        truth = truth.step()
    assert found == [
        (OUTSIDE, 0, 0),
        (0, 0, 1),  # the move to come is east
        (1, 0, 1),
        (7, 1, 1),  # north
        (7, 0, 0),  # it stands
        (OUTSIDE, 0, 0),
        (OUTSIDE, 0, 0),  # after the end nobody is there
    ]


@pytest.mark.example
def test_a_step_leaves_the_truth_as_it_was() -> None:
    truth = RecordedTruth(np.array([[(0.5, 0.5)], [(2.5, 0.5)]]), HALL, PARAMETERS)
    assert truth.step().cells.tolist() == [2]
    assert truth.cells.tolist() == [0]
    assert truth.positions_m.tolist() == [[0.5, 0.5]]
