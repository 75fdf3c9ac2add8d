"""``surveillance compare``: the paper's figure, with paired differences."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, INTERRUPTED, AsJson, InputError, answer, side_console
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
    refuse_twice,
    truth_kind,
    workers_checked,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from surveillance_domain.experiments.comparison import Plan
    from surveillance_domain.experiments.jobs import Finished, Outcome
    from surveillance_domain.experiments.kept_runs import KeptRuns

__all__ = ["compare", "compared"]


def compare(
    sites: Annotated[list[str], typer.Argument(metavar="SITE…", help="Built-in sites, or paths of site files.")],
    targets: Annotated[str, typer.Option(metavar="M,M,…", help="Numbers of targets.")] = "1,5,10,20",
    controllers: Annotated[
        str,
        typer.Option(
            metavar="C,C,…",
            help="Also lookahead: P over several steps; mp-hold, mp-dead-reckoning: MP keeping targets out of sight.",
        ),
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
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="A Dask scheduler such as tcp://host:8786, for its workers.")
    ] = None,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Compare controllers on the same simulated worlds: means, and paired differences to P, with 95 % intervals."""
    from surveillance_domain.commands.comparison_answer import comparison_content, comparison_tables, write_comparison
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.experiments.comparison import Plan
    from surveillance_domain.experiments.kept_runs import KeptRuns
    from surveillance_domain.experiments.setup import Setup, check_setup

    changed = overrides(option, detection_probability, cell_noise_m)
    counts, names = read_counts(targets), read_controllers(controllers)
    refuse_twice("SITE", sites)
    with input_checked():
        found = {site: check_setup(Setup(site, 1, **changed), names) for site in sites}
    refuse_twice("SITE", [str(site.path.resolve()) for site in found.values() if site.path is not None])
    labels = [site.name for site in found.values()]
    if len(set(labels)) < len(labels):
        raise InputError(f"two different site files have the same name: {', '.join(labels)}; rename one")
    setups = tuple(Setup(site, count, **changed) for site in found for count in counts)
    plan = Plan(setups, names, truth_kind(truth), steps, seed)
    if out is not None:
        ready_folder(out)
    with input_checked():
        kept = None if out is None else KeptRuns(out / "runs.jsonl")
    outcome = compared(plan, runs, workers or processors(), progress, kept, cluster)
    done = any(outcome.runs.values())
    inputs = {site.name: f"sha256:{site.digest}" for site in found.values()}
    named = {given: site.name for given, site in found.items()}
    content = comparison_content(plan, runs, outcome, named, COMMAND_LINE.get(), inputs)
    shown = comparison_tables(plan, outcome, named)
    if outcome.interrupted:
        shown = [*(shown if done else ()), _interrupted(outcome, runs * len(plan.cases), out)]
    if out is not None and done:
        write_comparison(out, plan, outcome, named, content)
        shown.append(f"Written to {out}")
    answer(content, shown, as_json=as_json)
    if outcome.interrupted:
        raise typer.Exit(INTERRUPTED)


def compared(
    plan: Plan,
    runs: int,
    workers: int,
    progress: bool | None = None,
    kept: KeptRuns | None = None,
    cluster: str | None = None,
) -> Outcome:
    """Do all runs of a plan, watched; those that are kept already are not done again."""
    from surveillance_domain.commands.progress import progress_bar
    from surveillance_domain.experiments.cluster import ClusterError, run_on_cluster
    from surveillance_domain.experiments.jobs import Outcome, blocks, run_jobs

    numbers = {case: range(runs) if kept is None else kept.missing(case, range(runs)) for case in plan.cases}
    jobs = [job for case in plan.cases for job in blocks(case, numbers[case])]
    wanted, left = runs * len(plan.cases), sum(len(job.runs) for job in jobs)
    if left < wanted:
        side_console().print(f"{wanted - left:,} of {wanted:,} runs are kept from before; {left:,} are left to do.")
    work = sum(_work(job.case.setup.targets) * len(job.runs) for job in jobs)
    with workers_checked(), input_checked((ClusterError,)), progress_bar("comparing", work, progress) as advance:

        def tell(batch: Sequence[Finished]) -> None:
            if kept is not None:
                kept.keep(batch)
            advance(sum(_work(one.case.setup.targets) for one in batch))

        outcome = run_jobs(jobs, workers, tell) if cluster is None else run_on_cluster(jobs, cluster, tell)
    if kept is None:
        return outcome
    found = {case: {n: run for n, run in kept.of(case).items() if n < runs} for case in plan.cases}
    return Outcome(found, outcome.interrupted)


def _interrupted(outcome: Outcome, wanted: int, out: Path | None) -> str:
    """How many runs there are, and how to go on."""
    finished = sum(map(len, outcome.runs.values()))
    if not finished:
        return "Interrupted; no run was finished, and nothing is written."
    onwards = "the same command goes on from them" if out else "with --out they would be kept, to go on from"
    return f"Interrupted; the {finished:,} of {wanted:,} runs that were finished are counted; {onwards}."


def _work(targets: int) -> int:
    """How long a run takes, relative to others; measured on the hall, good enough to foretell the end."""
    return 6 + targets
