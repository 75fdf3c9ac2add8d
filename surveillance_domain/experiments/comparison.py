"""A comparison of controllers: its cases, its rows, and the paired differences P − other."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from surveillance_domain.experiments.estimates import Estimate, paired, percent_obs_of
from surveillance_domain.experiments.runs import Run, TruthKind
from surveillance_domain.experiments.setup import Case, Setup

__all__ = ["Plan", "Row", "differences", "panels", "rows"]

Runs = Mapping[Case, Mapping[int, Run]]


@dataclass(frozen=True)
class Plan:
    """Which controllers are compared, and where.

    Attributes
    ----------
    setups : tuple of Setup
        Sites, each with a number of targets.
    controllers : tuple of str
    truth : {"grid", "continuous"}
    steps, seed : int
    reference : str
        The controller from which the others are subtracted.
    """

    setups: tuple[Setup, ...]
    controllers: tuple[str, ...]
    truth: TruthKind
    steps: int
    seed: int
    reference: str = "pomdp"

    def case(self, setup: Setup, controller: str) -> Case:
        """One cell of the table."""
        return Case(setup, controller, self.truth, self.steps, self.seed)

    @property
    def cases(self) -> list[Case]:
        """All cells, setup by setup."""
        return [self.case(*pair) for pair in itertools.product(self.setups, self.controllers)]


@dataclass(frozen=True)
class Row:
    """A controller at a setup and what is known of it."""

    setup: Setup
    controller: str
    estimate: Estimate
    restarts: int = 0


def rows(plan: Plan, runs: Runs) -> list[Row]:
    """PercentObs of every controller at every setup; cases without a finished run are left out."""
    made = []
    for case in plan.cases:
        done = runs.get(case, {})
        if done:
            restarts = sum(run.restarts for run in done.values())
            made.append(Row(case.setup, case.controller, percent_obs_of(done), restarts))
    return made


def differences(plan: Plan, runs: Runs) -> list[Row]:
    """PercentObs of the reference minus that of every other controller, over the runs that both have."""
    made = []
    for setup, controller in itertools.product(plan.setups, plan.controllers):
        if controller == plan.reference:
            continue
        pair = (runs.get(plan.case(setup, name), {}) for name in (plan.reference, controller))
        difference = paired(*pair)
        if difference.samples:
            made.append(Row(setup, controller, difference))
    return made


def panels(found: Sequence[Row]) -> dict[str, dict[str, list[Row]]]:
    """Rows by site, and there by controller."""
    sorted_in: dict[str, dict[str, list[Row]]] = {}
    for row in found:
        sorted_in.setdefault(row.setup.site, {}).setdefault(row.controller, []).append(row)
    return sorted_in
