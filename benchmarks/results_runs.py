"""Simulating what pages of results ask for: what was finished is kept, and not done again after an interruption.

Besides runs of a controller there are two other kinds, told by what follows the controller's
name: ``pomdp:knows``, which share of the targets it can place, and ``pomdp:unaware``, a controller that believes in the
site as it is while its targets move as at a variant of it.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

from surveillance_domain.commands.progress import progress_bar
from surveillance_domain.control.factory import Setting
from surveillance_domain.control.loop import run_loop
from surveillance_domain.experiments.jobs import Finished, Job, blocks, side_by_side
from surveillance_domain.experiments.kept_runs import KeptRuns
from surveillance_domain.experiments.knowledge import knowledge
from surveillance_domain.experiments.runs import Run, run_of, simulated_world
from surveillance_domain.experiments.setup import Case, surveillance_of
from surveillance_domain.experiments.variants import make_variant
from surveillance_domain.experiments.ways import way_of

KNOWS, UNAWARE = ":knows", ":unaware"
Wanted = tuple[Case, int]
"""A case and how many runs of it."""
Simulated = Mapping[Case, Mapping[int, Run]]
_ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


def simulated(wanted: Sequence[Wanted], workers: int, kept: KeptRuns) -> Simulated:
    """All runs of some cases, those that are kept among them.

    Raises
    ------
    SystemExit
        After Ctrl-C, when what was finished is kept.
    """
    jobs = side_by_side(job for case, runs in wanted for job in blocks(case, kept.missing(case, range(runs))))
    with progress_bar("simulating", sum(_work(job.case) * len(job.runs) for job in jobs), True) as advance:
        try:
            for batch in _finished(jobs, workers):
                kept.keep(batch)
                advance(sum(_work(one.case) for one in batch))
        except KeyboardInterrupt:
            raise SystemExit(130) from None
    return {case: {n: run for n, run in kept.of(case).items() if n < runs} for case, runs in wanted}


def variant_name(site: str, parameter: str, value: str) -> str:
    """Name of the file of a site of which one parameter is changed."""
    return f"{site}_{parameter}_{value}.toml"


def base_of(path: str) -> str:
    """The site of which a file is a variant."""
    return Path(path).name.partition("_")[0]


def _finished(jobs: Sequence[Job], workers: int) -> Iterator[list[Finished]]:
    """Jobs as they are done, in this process or in several others."""
    if workers == 1:
        yield from map(_done, jobs)
        return
    for name in _ONE_THREAD:
        os.environ.setdefault(name, "1")
    pool = ProcessPoolExecutor(workers, get_context("spawn"), signal.signal, (signal.SIGINT, signal.SIG_IGN))
    try:
        for future in as_completed([pool.submit(_done, job) for job in jobs]):
            yield future.result()
    finally:
        pool.shutdown(cancel_futures=True)


def _done(job: Job) -> list[Finished]:
    return [Finished(job.case, number, _run(job.case, number)) for number in job.runs]


def _run(case: Case, number: int) -> Run:
    """One run, without its times."""
    name, _, kind = case.controller.partition(":")
    if f":{kind}" == KNOWS:
        return Run(100 * knowledge(replace(case, controller=name), number), (), 0)
    setup = case.setup
    watched = surveillance_of(setup)
    if name != "msp":  # nobody else reads what static cameras report
        watched = replace(watched, site=replace(watched.site, static_cameras=()))
    world = simulated_world(watched, case.truth, case.seed, number, way_of(case, number))
    believed = replace(setup, site=base_of(setup.site)) if f":{kind}" == UNAWARE else setup
    controller = make_variant(name, surveillance_of(believed), Setting(world, case.steps, number))
    return replace(run_of(run_loop(world, controller, case.steps), controller), decision_ms=())


def _work(case: Case) -> int:
    """How long a run takes, relative to others; good enough to foretell the end."""
    return 6 + case.setup.targets
