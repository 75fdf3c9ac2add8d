"""Runs over worker processes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from importlib import resources
from pathlib import Path

import pytest

from surveillance_domain.experiments.jobs import Finished, blocks, run_jobs
from surveillance_domain.experiments.setup import Case, Setup, check_setup, site_of
from surveillance_domain.site.faults import SiteError

CASES = [
    Case(Setup("tiny", targets, detection_probability=0.8), controller, truth, 8, 3)
    for targets, controller, truth in ((1, "pomdp", "grid"), (2, "msp", "continuous"), (2, "sys", "grid"))
]


@pytest.mark.example
def test_blocks_cut_runs_without_loss() -> None:
    jobs = blocks(CASES[0], range(1, 8), 3)
    assert [job.runs for job in jobs] == [(1, 2, 3), (4, 5, 6), (7,)]


@pytest.mark.end_to_end
def test_the_result_does_not_depend_on_the_number_of_workers() -> None:
    told: list[Finished] = []
    jobs = [job for case in CASES for job in blocks(case, range(4), 2)]
    before = os.environ.get("OPENBLAS_NUM_THREADS")
    alone, shared = run_jobs(jobs, 1), run_jobs(jobs, 2, told.extend)
    assert (alone.interrupted, shared.interrupted) == (False, False)
    assert _numbers(shared.runs) == _numbers(alone.runs)
    assert len(told) == 12
    assert os.environ.get("OPENBLAS_NUM_THREADS") == before


@pytest.mark.end_to_end
def test_ctrl_c_keeps_what_is_finished() -> None:
    def enough(batch: Sequence[Finished]) -> None:
        if batch[-1].number == 3:
            raise KeyboardInterrupt

    outcome = run_jobs(blocks(CASES[0], range(50)), 1, enough)
    assert outcome.interrupted
    assert sorted(outcome.runs[CASES[0]]) == [0, 1, 2, 3]


@pytest.mark.end_to_end
def test_a_fault_in_a_worker_is_told() -> None:
    with pytest.raises(ValueError, match="no controller 'nobody'"):
        run_jobs(blocks(Case(Setup("tiny", 1), "nobody", "grid", 2, 0), range(1)), 2)


@pytest.mark.example
def test_setups_change_cameras() -> None:
    assert {camera.cell_noise_m for camera in site_of(Setup("tiny", 1, cell_noise_m=0.3)).cameras} == {0.3}
    assert [one.noise_m for one in site_of(Setup("corridor", 1, static_kappa=0.4)).static_cameras] == [(0.2, 0.4)] * 2
    with pytest.raises(SiteError, match="detection_probability"):
        site_of(Setup("tiny", 1, detection_probability=1.5))


@pytest.mark.example
def test_what_a_controller_lacks_is_found_before_anything_is_run(tmp_path: Path) -> None:
    content = (resources.files("surveillance_domain.site") / "builtin" / "tiny.toml").read_text()
    site = tmp_path / "bare.toml"
    site.write_text(content.partition("[[static_cameras]]")[0])
    assert check_setup(Setup(str(site), 1), ("sys", "clairvoyant")).name == "bare"
    with pytest.raises(ValueError, match=r"bare has no \[\[static_cameras\]\], which the controller msp needs"):
        check_setup(Setup(str(site), 1), ("sys", "msp"))
    with pytest.raises(ValueError, match="no controller 'nobody'"):
        check_setup(Setup("tiny", 1), ("sys", "nobody"))


def _numbers(runs: dict[Case, dict[int, object]]) -> dict[Case, dict[int, tuple[float, int]]]:
    return {case: {n: (run.percent_obs, run.restarts) for n, run in done.items()} for case, done in runs.items()}
