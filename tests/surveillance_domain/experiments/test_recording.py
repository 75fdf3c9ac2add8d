"""A recorded run says what the run was."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.experiments.knowledge import knowledge
from surveillance_domain.experiments.recording import record_run, write_steps
from surveillance_domain.experiments.runs import simulate_run
from surveillance_domain.experiments.setup import Case, Setup, surveillance_of

CASE = Case(Setup("tiny", 3), "pomdp", "continuous", 12, 4)


@pytest.mark.end_to_end
def test_recording_changes_nothing() -> None:
    recording = record_run(CASE, 1)
    plain = simulate_run(surveillance_of(CASE.setup), "pomdp", 12, 4, 1, "continuous")
    assert (recording.run.percent_obs, recording.run.restarts) == (plain.percent_obs, plain.restarts)
    assert recording.frames[-1].percent_obs == pytest.approx(plain.percent_obs)


@pytest.mark.end_to_end
def test_frames_agree_with_the_sightings() -> None:
    recording = record_run(CASE, 0)
    site = surveillance_of(CASE.setup).site
    for frame, step in zip(recording.frames, recording.steps, strict=True):
        assert frame.observed.sum() == step.observed
        names = [camera.presets[preset].name for camera, preset in zip(site.cameras, frame.presets, strict=True)]
        assert names == list(step.sighting.views.values())
        assert frame.expected is not None
        assert frame.expected.sum() == pytest.approx(3)
        seen = frame.positions_m[frame.observed]
        assert (frame.expected[site.grid.number_at(seen)] >= 1 - 1e-9).all()


@pytest.mark.end_to_end
def test_without_a_belief_there_is_no_heat() -> None:
    assert record_run(Case(Setup("tiny", 1), "mp", "grid", 2, 0), 0).frames[0].expected is None


@pytest.mark.end_to_end
def test_the_table_has_a_line_for_each_step(tmp_path: Path) -> None:
    recording = record_run(CASE, 0)
    write_steps(recording, tmp_path / "steps.csv")
    with (tmp_path / "steps.csv").open(newline="") as file:
        lines = list(csv.DictReader(file))
    assert [int(line["step"]) for line in lines] == list(range(1, 13))
    assert [int(line["observed"]) for line in lines] == [step.observed for step in recording.steps]
    assert float(lines[-1]["percent_obs_so_far"]) == pytest.approx(recording.run.percent_obs, abs=1e-3)
    assert lines[0]["south-west"] in ("left", "middle", "right")


@pytest.mark.end_to_end
def test_who_sees_nothing_but_exact_sightings_knows_what_he_sees() -> None:
    """Under perfect eyes MP places exactly the targets that it observes; P knows these and more."""
    mp = Case(Setup("tiny", 3), "mp", "grid", 12, 4)
    observed = simulate_run(surveillance_of(mp.setup), "mp", 12, 4, 0).percent_obs
    assert 100 * knowledge(mp, 0) == pytest.approx(observed)
    ours = Case(Setup("tiny", 3), "pomdp", "grid", 12, 4)
    assert 100 * knowledge(ours, 0) > simulate_run(surveillance_of(mp.setup), "pomdp", 12, 4, 0).percent_obs
    assert np.isclose(knowledge(Case(Setup("tiny", 3, static_kappa=0.0), "msp", "grid", 12, 4), 0), 1.0, atol=0.05)
    with pytest.raises(ValueError, match="sys places no targets"):
        knowledge(Case(Setup("tiny", 1), "sys", "grid", 2, 0), 0)
