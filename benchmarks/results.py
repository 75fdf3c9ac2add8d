"""Make docs/results.md anew: every controller on hall, corridor and junction, under both kinds of truth.

``python benchmarks/results.py`` makes 30 runs of each case, ``--full`` 100. All runs stand in docs/figures/runs.csv;
the page and its figures are made from that file alone, so ``--text-only`` writes them again without simulating.
"""

from __future__ import annotations

import argparse
import csv
import os
import shlex
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from results_figures import draw_figures
from results_myopia_text import section
from results_table import RUNS, SIMULATED, Key, Results, write_text
from results_text import page

from surveillance_domain.commands.options import processors
from surveillance_domain.commands.progress import progress_bar
from surveillance_domain.experiments.jobs import blocks, run_jobs
from surveillance_domain.experiments.knowledge import knowledge
from surveillance_domain.experiments.runs import TruthKind
from surveillance_domain.experiments.setup import Case, Setup, surveillance_of

SITES = ("hall", "corridor", "junction")
COUNTS = (1, 5, 10, 20)
KAPPAS = (0.0, 0.05, 0.1, 0.2, 0.4, 0.8)
KAPPA_COUNTS = (5, 20)
TRUTHS: tuple[TruthKind, ...] = ("grid", "continuous")
STEPS = 100
KNOWLEDGE_RUNS = 5
DOCS = Path(__file__).parents[1] / "docs"


def main() -> None:
    """Simulate, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true", help="100 runs instead of 30")
    parser.add_argument("--runs", type=int, help="another number of runs")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=processors())
    parser.add_argument("--out", type=Path, default=DOCS, help="folder for results.md and figures/")
    parser.add_argument("--text-only", action="store_true", help="write the page again from figures/runs.csv")
    given = parser.parse_args()
    figures = given.out / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    if not given.text_only:
        runs = given.runs or (100 if given.full else 30)
        rows = [*_simulated(list(_cases(given.seed)), runs, given.workers), *_known(given.seed)]
        _write_csv(figures / RUNS, rows)
    results = Results.read(figures / RUNS)
    draw_figures(results, figures)
    arguments = [one for one in sys.argv[1:] if one != "--text-only"]
    command = shlex.join(["python", "benchmarks/results.py", *arguments])
    last = section(figures)
    write_text(given.out / "results.md", page(results, command) + (f"\n{last}" if last else ""))
    print(f"Written: {given.out / 'results.md'} and the figures in {figures}")


def _cases(seed: int) -> Iterator[Case]:
    for truth in TRUTHS:
        for site in SITES:
            for count in COUNTS:
                for controller in SIMULATED:
                    yield Case(Setup(site, count), controller, truth, STEPS, seed)
            for count in KAPPA_COUNTS:
                for kappa in KAPPAS:
                    yield Case(Setup(site, count, static_kappa=kappa), "msp", truth, STEPS, seed)


def _simulated(cases: list[Case], runs: int, workers: int) -> Iterator[tuple[Key, float, int]]:
    """Every run's key, PercentObs and restarts."""
    jobs = [job for case in cases for job in blocks(case, range(runs))]
    work = sum((6 + job.case.setup.targets) * len(job.runs) for job in jobs)
    with progress_bar("simulating", work, True) as advance:
        outcome = run_jobs(jobs, workers, lambda batch: advance(sum(6 + one.case.setup.targets for one in batch)))
    if outcome.interrupted:
        raise SystemExit(130)
    for case, done in outcome.runs.items():
        for number, run in sorted(done.items()):
            yield _key("percent-obs", case, number), run.percent_obs, run.restarts


def _known(seed: int) -> Iterator[tuple[Key, float, int]]:
    """Share of target-steps of which a controller knows the cell to within one."""
    for truth in TRUTHS:
        for site in SITES:
            setups = [Setup(site, 5), *(Setup(site, 5, static_kappa=kappa) for kappa in KAPPAS)]
            for setup in setups:
                for controller in ("pomdp", "mp") if setup.static_kappa is None else ("msp",):
                    case = Case(setup, controller, truth, STEPS, seed)
                    for number in range(KNOWLEDGE_RUNS):
                        yield _key("known", case, number), 100 * knowledge(case, number), 0
            surveillance_of.cache_clear()


def _key(what: str, case: Case, number: int) -> Key:
    setup = case.setup
    kappa = "" if setup.static_kappa is None else f"{setup.static_kappa:g}"
    return Key(what, case.truth, setup.site, setup.targets, case.controller, kappa, number, case.steps, case.seed)


def _write_csv(path: Path, rows: Iterable[tuple[Key, float, int]]) -> None:
    beside = path.with_name(f".{path.name}")
    with beside.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow([*Key._fields, "percent", "restarts"])
        for key, percent, restarts in rows:
            writer.writerow([*key, f"{percent:.6g}", restarts])
    os.replace(beside, path)


if __name__ == "__main__":
    main()
