"""Worlds that are remembered for all their controllers are the worlds that each would have met alone."""

from __future__ import annotations

from dataclasses import replace

import pytest

from surveillance_domain.experiments.jobs import Job, blocks, run_jobs, side_by_side
from surveillance_domain.experiments.runs import TruthKind, simulate_run
from surveillance_domain.experiments.setup import Case, Setup, surveillance_of
from surveillance_domain.experiments.ways import way_of

CASE = Case(Setup("tiny", 2), "pomdp", "grid", 8, 7)


@pytest.mark.property
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_every_controller_meets_the_world_that_it_would_meet_alone(truth: TruthKind) -> None:
    names, setup = ("pomdp", "mp", "msp", "clairvoyant"), Setup("tiny", 2, 0.8)
    cases = [replace(CASE, controller=name, truth=truth, setup=setup) for name in names]
    done = run_jobs([Job(case, (0, 1)) for case in cases]).runs
    for case in cases:
        for number, run in done[case].items():
            alone = simulate_run(surveillance_of(case.setup), case.controller, 8, 7, number, truth)
            assert (run.percent_obs, run.restarts) == (alone.percent_obs, alone.restarts), (case.controller, number)


@pytest.mark.example
def test_a_world_is_worked_out_once() -> None:
    first, second = way_of(CASE, 0), way_of(replace(CASE, controller="stat"), 0)
    assert first is not None
    assert first is second
    assert first.step() is first.step()
    assert way_of(CASE, 1) is not first
    assert way_of(replace(CASE, seed=8), 0) is not first


@pytest.mark.example
@pytest.mark.parametrize(("steps", "targets"), [(5_001, 1), (1_001, 100)])
def test_a_long_run_is_not_remembered(steps: int, targets: int) -> None:
    assert way_of(replace(CASE, steps=steps, setup=Setup("tiny", targets)), 0) is None


@pytest.mark.example
def test_jobs_of_the_same_worlds_are_neighbours() -> None:
    cases = [replace(CASE, setup=Setup("tiny", m), controller=name) for m in (1, 2) for name in ("pomdp", "mp")]
    ordered = side_by_side(job for case in cases for job in blocks(case, range(4), 2))
    told = [(job.case.setup.targets, job.runs, job.case.controller) for job in ordered]
    assert told == [(m, runs, name) for m in (1, 2) for runs in ((0, 1), (2, 3)) for name in ("pomdp", "mp")]
