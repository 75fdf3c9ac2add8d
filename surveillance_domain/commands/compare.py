"""``surveillance compare``: the paper's figure, with paired differences."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, INTERRUPTED, AsJson, InputError, answer
from surveillance_domain.commands.options import (
    CellNoise,
    DetectionProbability,
    Overrides,
    Progress,
    Seed,
    Steps,
    Truth,
    TruthChoice,
    Workers,
    input_checked,
    overrides,
    processors,
    read_controllers,
    read_counts,
    truth_kind,
    workers_checked,
)

if TYPE_CHECKING:
    from surveillance_domain.experiments.comparison import Plan
    from surveillance_domain.experiments.jobs import Outcome

__all__ = ["compare", "compared"]


def compare(
    sites: Annotated[list[str], typer.Argument(metavar="SITE…", help="Built-in sites, or paths of site files.")],
    targets: Annotated[str, typer.Option(metavar="M,M,…", help="Numbers of targets.")] = "1,5,10,20",
    controllers: Annotated[
        str,
        typer.Option(metavar="C,C,…", help="Also mp-hold and mp-dead-reckoning: MP with targets out of sight kept."),
    ] = "pomdp,mp,msp,sys,stat,full-information,clairvoyant",
    steps: Steps = 100,
    runs: Annotated[
        int, typer.Option(min=1, help="Of every controller, at every site, for every number of targets.")
    ] = 30,
    seed: Seed = 0,
    truth: TruthChoice = Truth.grid,
    detection_probability: DetectionProbability = None,
    cell_noise_m: CellNoise = None,
    option: Overrides = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder for the figure (PNG, SVG) and the tables (CSV, JSON).")
    ] = None,
    workers: Workers = None,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Compare controllers on the same simulated worlds: means, and paired differences to P, with 95 % intervals."""
    from surveillance_domain.commands.comparison_answer import comparison_content, comparison_tables, write_comparison
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.experiments.comparison import Plan
    from surveillance_domain.experiments.setup import Setup, check_setup

    changed = overrides(option, detection_probability, cell_noise_m)
    counts, names = read_counts(targets), read_controllers(controllers)
    if out is not None:
        ready_folder(out)
    with input_checked():
        found = {site: check_setup(Setup(site, 1, **changed), names) for site in dict.fromkeys(sites)}
    labels = [site.name for site in found.values()]
    if len(set(labels)) < len(labels):
        raise InputError(f"two different site files have the same name: {', '.join(labels)}; rename one")
    setups = tuple(Setup(site, count, **changed) for site in found for count in counts)
    plan = Plan(setups, names, truth_kind(truth), steps, seed)
    outcome = compared(plan, runs, workers or processors(), progress)
    inputs = {site.name: f"sha256:{site.digest}" for site in found.values()}
    named = {given: site.name for given, site in found.items()}
    content = comparison_content(plan, runs, outcome, named, COMMAND_LINE.get(), inputs)
    shown = comparison_tables(plan, outcome, named)
    if outcome.interrupted:
        shown.append("Interrupted; the runs that were finished are counted.")
    if out is not None:
        write_comparison(out, plan, outcome, named, content)
        shown.append(f"Written to {out}")
    answer(content, shown, as_json=as_json)
    if outcome.interrupted:
        raise typer.Exit(INTERRUPTED)


def compared(plan: Plan, runs: int, workers: int, progress: bool | None = None) -> Outcome:
    """Do all runs of a plan, watched."""
    from surveillance_domain.commands.progress import progress_bar
    from surveillance_domain.experiments.jobs import blocks, run_jobs

    jobs = [job for case in plan.cases for job in blocks(case, range(runs))]
    work = sum(_work(job.case.setup.targets) * len(job.runs) for job in jobs)
    with workers_checked(), progress_bar("comparing", work, progress) as advance:
        return run_jobs(jobs, workers, lambda batch: advance(sum(_work(one.case.setup.targets) for one in batch)))


def _work(targets: int) -> int:
    """How long a run takes, relative to others; measured on the hall, good enough to foretell the end."""
    return 6 + targets
