"""Measure the price of being myopic, and write its section of docs/results.md.

``python benchmarks/results_myopia.py`` solves two rooms with one target by `point-based` and sets the myopic policy and
the lookahead against the solution; then it runs P, the lookahead and full information in the hall, with quick cameras
and with slow ones. All runs go to docs/figures/price.csv and lookahead.csv; the section is made from those alone.

A policy π falls short of the solution's by ``V(b₀) − J(π) = E Σ γᵗ [V(b_t) − Q(b_t, a_t)]`` over beliefs and actions of
π's own runs, V being the solution's lower bound and Q what it gives one step on (Kakade and Langford, "Approximately
optimal approximate reinforcement learning", ICML 2002): an identity for any V, with far less noise than returns have.
"""

from __future__ import annotations

import argparse
import csv
import io
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from results_myopia_text import HEADING, LOOKAHEAD, PRICE, HallRun, PriceRun, section
from results_table import write_text

import factored_pomdp as fp
from solvers import DecomposedMyopic, Limits, PointBased
from solvers.lookahead import Lookahead
from surveillance_domain.commands.options import processors
from surveillance_domain.commands.progress import progress_bar
from surveillance_domain.experiments.jobs import blocks, run_jobs
from surveillance_domain.experiments.setup import Case, Setup

SITES = Path(__file__).parent / "sites"
ROOMS = ("room", "room-slow")
HALLS = {"hall": "hall", "hall-slow": str(SITES / "hall-slow.toml")}
COUNTS = (1, 5)
CONTROLLERS = ("pomdp", "lookahead", "full-information")
DISCOUNT, PRECISION = 0.95, 0.01
PRICE_STEPS, HALL_STEPS = 150, 100
DOCS = Path(__file__).parents[1] / "docs"


def main() -> None:
    """Solve, simulate, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=30, help="in the hall; in the rooms twice as many")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=processors())
    parser.add_argument(
        "--only", choices=("rooms", "halls", "text"), help="one part, the rest as it stands in figures/"
    )
    parser.add_argument("--out", type=Path, default=DOCS, help="folder for results.md and figures/")
    given = parser.parse_args()
    figures = given.out / "figures"
    figures.mkdir(parents=True, exist_ok=True)
    if given.only in (None, "rooms"):
        _write_csv(figures / PRICE, PriceRun._fields, _priced(2 * given.runs, given.seed))
    if given.only in (None, "halls"):
        _write_csv(figures / LOOKAHEAD, HallRun._fields, _simulated(given.runs, given.seed, given.workers))
    text = section(figures)
    if text:
        page = given.out / "results.md"
        before = page.read_text(encoding="utf-8").partition(f"\n{HEADING}")[0] if page.exists() else "# Results"
        write_text(page, f"{before.rstrip()}\n\n{text}")
        print(f"Written: the section in {page}", file=sys.stderr)


def _priced(runs: int, seed: int) -> Iterator[PriceRun]:
    """By how much each policy falls short of the solution, run by run."""
    for room in ROOMS:
        model = fp.domain("surveillance", site=str(SITES / f"{room}.toml"), targets=1, discount=DISCOUNT)
        found = PointBased(model).solve(Limits(precision=PRECISION, time_limit=600))
        keep = {variable.name: variable.name.replace(".move", ".preset") for variable in model.actions}
        actors = {"pomdp": _Myopic(model, keep), "lookahead": Lookahead(model, keep=keep)}
        with progress_bar(f"pricing in {room}", runs * len(actors), True) as advance:
            for name, actor in actors.items():
                for run in range(runs):
                    short = _shortfall(model, found.policy, actor, np.random.default_rng([seed, run]))
                    advance(1)
                    yield PriceRun(room, name, run, short, found.lower, found.upper, DISCOUNT, PRICE_STEPS, seed)


class _Myopic:
    """P's choice: one step ahead, the present presets kept where that costs nothing."""

    def __init__(self, model: fp.FactoredPOMDP, keep: dict[str, str]) -> None:
        self._solver, self._keep = DecomposedMyopic(model), keep

    def decide(self, belief: fp.ProductBelief) -> Any:
        return self._solver.decide(belief, {move: belief.known[preset] for move, preset in self._keep.items()})


def _shortfall(model: fp.FactoredPOMDP, policy: Any, actor: Any, rng: np.random.Generator) -> float:
    """``Σ γᵗ [V(b_t) − Q(b_t, a_t)]`` over one run of an actor."""
    world, belief = fp.Simulation(model), fp.initial_belief(model)
    state, short, weight = world.start(rng), 0.0, 1.0
    for _ in range(PRICE_STEPS):
        action = dict(actor.decide(belief).action)
        worth = next(value for other, value in policy.values(belief) if other == action)
        short += weight * (policy.decide(belief).value - worth)
        state, seen, _ = world.step(state, action, rng)
        belief = belief.predict(action).condition(seen, known={name: state[name] for name in belief.known})
        weight *= model.discount
    return short


def _simulated(runs: int, seed: int, workers: int) -> Iterator[HallRun]:
    """PercentObs of every run in the hall."""
    cases = {
        Case(Setup(site, count), controller, "grid", HALL_STEPS, seed): name
        for name, site in HALLS.items()
        for count in COUNTS
        for controller in CONTROLLERS
    }
    jobs = [job for case in cases for job in blocks(case, range(runs), 2)]
    with progress_bar("simulating", len(cases) * runs, True) as advance:
        outcome = run_jobs(jobs, workers, lambda batch: advance(len(batch)))
    if outcome.interrupted:
        raise SystemExit(130)
    for case, done in outcome.runs.items():
        for number, run in sorted(done.items()):
            setup = case.setup
            yield HallRun(cases[case], setup.targets, case.controller, number, run.percent_obs, HALL_STEPS, seed)


def _write_csv(path: Path, heads: Iterable[str], rows: Iterable[tuple[object, ...]]) -> None:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    for row in rows:
        writer.writerow([f"{value:.8g}" if isinstance(value, float) else value for value in row])
    write_text(path, text.getvalue())


if __name__ == "__main__":
    main()
