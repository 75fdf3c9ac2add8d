"""Many runs over worker processes; what comes out does not depend on how many there are.

A job is a block of runs of one case. Every worker keeps the last few models that it built, and runs on one thread.
Ctrl-C ends every worker at its next step; the runs that were finished by then are kept.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context, parent_process
from multiprocessing.synchronize import Event
from typing import Protocol

from surveillance_domain.control.loop import Step
from surveillance_domain.experiments.runs import Run, simulate_run
from surveillance_domain.experiments.setup import Case, surveillance_of
from surveillance_domain.experiments.ways import way_of

__all__ = ["Finished", "Job", "Outcome", "blocks", "do_job", "run_jobs", "side_by_side"]

_ONE_THREAD = {
    name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
}


@dataclass(frozen=True)
class Job:
    """Some runs of a case, by their numbers."""

    case: Case
    runs: tuple[int, ...]


@dataclass(frozen=True)
class Finished:
    """A run that is over."""

    case: Case
    number: int
    run: Run


@dataclass(frozen=True)
class Outcome:
    """All runs that were finished, by case and number; ``interrupted``: Ctrl-C came before the last of them."""

    runs: dict[Case, dict[int, Run]]
    interrupted: bool = False


_Told = Callable[[Sequence[Finished]], None]


class _Flag(Protocol):
    def is_set(self) -> bool: ...


class _Stopped(Exception):
    """The user does not want to wait any longer."""


def blocks(case: Case, runs: Iterable[int], size: int = 5) -> list[Job]:
    """A case's runs, cut into jobs."""
    numbers = list(runs)
    return [Job(case, tuple(numbers[start : start + size])) for start in range(0, len(numbers), size)]


def side_by_side(jobs: Iterable[Job]) -> list[Job]:
    """Jobs in an order in which those of the same worlds are neighbours, so that these are worked out once."""
    setups: dict[tuple[object, ...], int] = {}

    def place(job: Job) -> tuple[int, tuple[int, ...]]:
        case = job.case
        return setups.setdefault((case.setup, case.truth, case.steps, case.seed), len(setups)), job.runs

    return sorted(jobs, key=place)


def run_jobs(
    jobs: Sequence[Job], workers: int = 1, tell: Callable[[Sequence[Finished]], None] | None = None
) -> Outcome:
    """Do the jobs, in this process (``workers=1``) or in several others.

    Parameters
    ----------
    tell : callable, optional
        Told of finished runs as they come in, in any order.

    Raises
    ------
    concurrent.futures.process.BrokenProcessPool
        If a worker is killed from outside, for want of memory say.
    """
    found: dict[Case, dict[int, Run]] = {job.case: {} for job in jobs}
    jobs = side_by_side(jobs)

    def keep(batch: Sequence[Finished]) -> None:
        for one in batch:
            found[one.case][one.number] = one.run

    try:
        if workers == 1:
            _in_this_process(jobs, keep, tell)
        else:
            _in_workers(jobs, workers, keep, tell)
    except KeyboardInterrupt:
        return Outcome(found, interrupted=True)
    return Outcome(found)


def _in_this_process(jobs: Sequence[Job], keep: _Told, tell: _Told | None) -> None:
    for job in jobs:
        for number in job.runs:
            batch = [_finished(job.case, number)]
            keep(batch)
            if tell is not None:
                tell(batch)


def _in_workers(jobs: Sequence[Job], workers: int, keep: _Told, tell: _Told | None) -> None:
    """On Ctrl-C what the workers had finished is kept, and the interrupt goes on."""
    context = get_context("spawn")
    stop = context.Event()
    pool = ProcessPoolExecutor(max(1, min(workers, len(jobs))), context, initializer=_begin, initargs=(stop,))
    futures: list[Future[list[Finished]]] = []
    try:
        with _one_thread_each(), _interrupts_held():
            futures.extend(pool.submit(do_job, job) for job in jobs)
        for future in as_completed(futures):
            batch = future.result()
            keep(batch)
            if tell is not None:
                tell(batch)
    except KeyboardInterrupt:
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)
        for future in futures:
            if not future.cancelled():
                keep(future.result())
        raise
    finally:
        stop.set()
        pool.shutdown(wait=True, cancel_futures=True)


def _finished(case: Case, number: int, each: Callable[[Step], None] | None = None) -> Finished:
    surveillance = surveillance_of(case.setup)
    start = way_of(case, number)
    run = simulate_run(surveillance, case.controller, case.steps, case.seed, number, case.truth, each, start)
    return Finished(case, number, run)


# ------------------------------------------------------------------------------------------------------ in a worker

_stop: _Flag = threading.Event()


def _begin(stop: Event) -> None:
    """Remember whom to listen to, and do not outlive the process that asked."""
    global _stop
    _stop = stop
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def do_job(job: Job) -> list[Finished]:
    """A job's runs; those finished so far if the stop is called."""
    done: list[Finished] = []
    try:
        for number in job.runs:
            _stop_if_asked(None)
            done.append(_finished(job.case, number, _stop_if_asked))
    except _Stopped:
        pass
    return done


def _stop_if_asked(_step: Step | None) -> None:
    if _stop.is_set():
        raise _Stopped


# ------------------------------------------------------------------------------------------------- starting workers


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes started in here do their linear algebra on one thread."""
    before = {name: os.environ.get(name) for name in _ONE_THREAD}
    os.environ.update(_ONE_THREAD)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value


@contextmanager
def _interrupts_held() -> Iterator[None]:
    """Processes started in here never see Ctrl-C, not even while they load; here it arrives at the end."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
