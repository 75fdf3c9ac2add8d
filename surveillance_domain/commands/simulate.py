"""``surveillance simulate``: the main job, with simulated cameras and targets."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, INTERRUPTED, AsJson, InputError, answer, table
from surveillance_domain.commands.options import (
    CellNoise,
    DetectionProbability,
    Overrides,
    Progress,
    Seed,
    SiteName,
    Steps,
    Truth,
    TruthChoice,
    Workers,
    input_checked,
    overrides,
    read_controllers,
    truth_kind,
    workers_checked,
)
from surveillance_domain.commands.run_answer import measured, shown_runs, write_run

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.experiments.recording import Recording
    from surveillance_domain.experiments.runs import Run
    from surveillance_domain.experiments.setup import Case

__all__ = ["simulate", "simulated"]


def simulate(
    site: SiteName,
    targets: Annotated[int, typer.Option(min=1, help="How many.")] = 5,
    controller: Annotated[
        str, typer.Option(help="pomdp, mp, msp, sys, stat, full-information, clairvoyant.")
    ] = "pomdp",
    steps: Steps = 100,
    runs: Annotated[int, typer.Option(min=1, help="How many.")] = 10,
    seed: Seed = 0,
    truth: TruthChoice = Truth.grid,
    detection_probability: DetectionProbability = None,
    cell_noise_m: CellNoise = None,
    option: Overrides = None,
    out: Annotated[Path | None, typer.Option(help="Folder for an animation of the first run, and tables.")] = None,
    workers: Workers = 1,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Let one controller run, and say which share of the targets it observed."""
    from surveillance_domain.experiments.setup import Case, Setup

    (name, *others) = read_controllers(controller)
    if others:
        raise InputError(f"--controller {controller}: one controller; for several there is surveillance compare")
    setup = Setup(site, targets, **overrides(option, detection_probability, cell_noise_m))
    case = Case(setup, name, truth_kind(truth), steps, seed)
    content, interrupted = simulated(case, runs, out, workers or 1, progress)
    answer(content, _shown(content, out), as_json=as_json)
    if interrupted:
        raise typer.Exit(INTERRUPTED)


def simulated(
    case: Case, runs: int, out: Path | None = None, workers: int = 1, progress: bool | None = None
) -> tuple[dict[str, Any], bool]:
    """Simulate a case: the answer as JSON has it, and whether Ctrl-C cut it short.

    With ``out`` the first run is recorded, and the folder holds ``run.gif``, ``last-step.png`` and ``.svg``,
    ``steps.csv``, ``result.json`` and ``provenance.json``.
    """
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.commands.progress import progress_bar
    from surveillance_domain.experiments.jobs import blocks, run_jobs
    from surveillance_domain.experiments.recording import record_run
    from surveillance_domain.experiments.setup import check_setup

    with input_checked():
        site = check_setup(case.setup, (case.controller,))
    if out is not None:
        ready_folder(out)
    done: dict[int, Run] = {}
    recording = None
    with progress_bar(f"simulating {site.name}", runs, progress) as advance:
        try:
            if out is not None:
                recording = record_run(case, 0)
                done[0] = recording.run
                advance(1)
            jobs = blocks(case, range(len(done), runs), max(1, min(5, runs // (4 * workers))))
            with workers_checked():
                outcome = run_jobs(jobs, workers, lambda batch: advance(len(batch)))
            done |= outcome.runs.get(case, {})
            interrupted = outcome.interrupted
        except KeyboardInterrupt:
            interrupted = True
    content = _content(case, site.name, done, interrupted, {site.name: f"sha256:{site.digest}"})
    if out is not None:
        _write(out, case, recording, content)
    return content, interrupted


def _content(
    case: Case, site: str, done: Mapping[int, Run], interrupted: bool, inputs: Mapping[str, str]
) -> dict[str, Any]:
    from factored_pomdp.provenance import provenance

    carried = provenance(COMMAND_LINE.get(), inputs, case.seed)
    return {
        "site": site,
        "controller": case.controller,
        "targets": case.setup.targets,
        "steps": case.steps,
        "truth": case.truth,
        "detection_probability": case.setup.detection_probability,
        "cell_noise_m": case.setup.cell_noise_m,
        **measured(done),
        "interrupted": interrupted,
        **carried,
        "provenance": carried,
    }


def _write(out: Path, case: Case, recording: Recording | None, content: Mapping[str, Any]) -> None:
    from surveillance_domain.experiments.setup import surveillance_of
    from surveillance_domain.experiments.variants import ALL_NAMES

    surveillance = surveillance_of(case.setup)
    named = f"{case.setup.targets} target{'s' if case.setup.targets > 1 else ''}"
    heading = f"{surveillance.site.name}, controller {ALL_NAMES[case.controller]}, {named}"
    write_run(out, surveillance, recording, heading, content)


def _shown(content: Mapping[str, Any], out: Path | None) -> list[RenderableType]:
    rows = table("simulated", "found", right=["found"])
    for key in ("site", "controller", "targets", "steps", "runs", "truth"):
        rows.add_row(key, str(content[key]))
    return shown_runs(rows, content, out)
