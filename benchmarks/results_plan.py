"""What is simulated for docs/results.md: cases of the comparison, and the rows that their runs make."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from results_runs import KNOWS, Simulated, Wanted
from results_table import Key

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.runs import TruthKind
from surveillance_domain.experiments.setup import Case, Setup

OUT_OF_SIGHT = ("mp-hold", "mp-dead-reckoning")
KAPPAS = (0.0, 0.05, 0.1, 0.2, 0.4, 0.8)
TRUTHS: tuple[TruthKind, ...] = ("grid", "continuous")
KNOWN_COUNT, KNOWN_RUNS = 5, 5
"""At how many targets, and over how many runs, it is measured what a controller knows."""


@dataclass(frozen=True)
class Extent:
    """Where things are compared: sites, numbers of targets (and the few of them for sensitivity), length of a run."""

    sites: tuple[str, ...] = ("hall", "corridor", "junction")
    counts: tuple[int, ...] = tuple(range(1, 21))
    few_counts: tuple[int, ...] = (5, 20)
    steps: int = 100


def comparison(extent: Extent, seed: int, runs: int, few_runs: int) -> Iterator[Wanted]:
    """Every controller at every site; with ``few_runs`` runs MP's variants and MSP under other noise."""
    for truth in TRUTHS:
        for site in extent.sites:
            for count in extent.counts:
                for controller in COMPARED:
                    yield Case(Setup(site, count), controller, truth, extent.steps, seed), runs
                if count not in extent.few_counts:
                    continue
                for controller in OUT_OF_SIGHT:
                    yield Case(Setup(site, count), controller, truth, extent.steps, seed), few_runs
                for kappa in KAPPAS:
                    yield Case(Setup(site, count, static_kappa=kappa), "msp", truth, extent.steps, seed), few_runs
            known_runs = min(KNOWN_RUNS, few_runs)
            for controller in ("pomdp", "mp"):
                yield Case(Setup(site, KNOWN_COUNT), controller + KNOWS, truth, extent.steps, seed), known_runs
            for kappa in KAPPAS:
                setup = Setup(site, KNOWN_COUNT, static_kappa=kappa)
                yield Case(setup, "msp" + KNOWS, truth, extent.steps, seed), known_runs


def rows(simulated: Simulated) -> Iterator[tuple[object, ...]]:
    """A row for each run: its key, PercentObs (or the share known), restarts."""
    for case, done in simulated.items():
        for number, run in sorted(done.items()):
            yield *key(case, number), run.percent_obs, run.restarts


def key(case: Case, number: int, site: str | None = None) -> Key:
    """Under which a run stands in a table; ``site`` instead of the setup's."""
    setup = case.setup
    kappa = "" if setup.static_kappa is None else f"{setup.static_kappa:g}"
    what = "known" if case.controller.endswith(KNOWS) else "percent-obs"
    controller = case.controller.removesuffix(KNOWS)
    return Key(what, case.truth, site or setup.site, setup.targets, controller, kappa, number, case.steps, case.seed)
