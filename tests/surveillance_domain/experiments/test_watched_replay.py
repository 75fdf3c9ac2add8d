"""Who was there, who was seen, and of whom that is not so why."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.experiments.replay import Watched
from surveillance_domain.experiments.runs import Run


@pytest.mark.example
def test_who_is_missed_is_unmet_until_somebody_sees_them_and_lost_from_then_on() -> None:
    present = np.array([[1, 0], [1, 1], [1, 1], [1, 1], [0, 1]], dtype=bool)
    seen = np.array([[0, 0], [1, 0], [0, 0], [1, 0], [0, 0]], dtype=bool)
    watched = Watched(Run(0.0, (), 0), present, seen)
    assert watched.unmet.tolist() == [[True, False], [False, True], [False, True], [False, True], [False, True]]
    assert watched.lost.tolist() == [[False, False], [False, False], [True, False], [False, False], [False, False]]
    assert np.array_equal(watched.unmet | watched.lost | seen, present)
