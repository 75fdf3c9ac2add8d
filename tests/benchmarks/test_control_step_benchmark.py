"""The control step on emulated cameras runs, and asks more of more cameras."""

from __future__ import annotations

import pytest

pytest.importorskip("cv2")

from benchmarks.control_step import control_step


@pytest.mark.end_to_end
def test_control_step_of_few_cameras() -> None:
    report = control_step(quick=True, seed=0, counts=(1, 3))
    assert [row[0] for row in report.rows] == ["1", "3"]
    assert report.figures[3]["questions_a_step"] > report.figures[1]["questions_a_step"] >= 2
    assert 0 < report.figures[3]["decision_s"] < report.figures[3]["step_s"]
    assert len(report.aims) == 1
