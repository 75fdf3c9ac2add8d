"""All runs behind docs/results.md, as they stand in figures/runs.csv."""

from __future__ import annotations

import csv
import os
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.estimates import Estimate, estimate

RUNS = "runs.csv"
SIMULATED = (*COMPARED, "mp-hold", "mp-dead-reckoning")
"""Controllers of which the file has runs."""
Case = tuple[str, str, str, int, str, str]
Panel = tuple[str, str, int]
"""Truth, site, number of targets."""


class Key(NamedTuple):
    """Which run of what; ``kappa`` is empty where the site's own holds, ``what`` is ``percent-obs`` or ``known``."""

    what: str
    truth: str
    site: str
    targets: int
    controller: str
    kappa: str
    run: int
    steps: int
    seed: int


@dataclass(frozen=True)
class Results:
    """Numbers by case and run; a case is a key's first six fields."""

    percent: dict[Case, dict[int, float]]
    restarts: dict[Case, int]
    steps: int
    seed: int

    @classmethod
    def read(cls, path: Path) -> Results:
        """From the file."""
        percent: dict[Case, dict[int, float]] = {}
        restarts: dict[Case, int] = {}
        with path.open(newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                case = (row["what"], row["truth"], row["site"], int(row["targets"]), row["controller"], row["kappa"])
                percent.setdefault(case, {})[int(row["run"])] = float(row["percent"])
                restarts[case] = restarts.get(case, 0) + int(row["restarts"])
        return cls(percent, restarts, int(row["steps"]), int(row["seed"]))

    def samples(
        self, truth: str, site: str, targets: int, controller: str, kappa: str = "", what: str = "percent-obs"
    ) -> dict[int, float]:
        """Percentages by number of the run."""
        return self.percent[what, truth, site, targets, controller, kappa]

    def mean(
        self, truth: str, site: str, targets: int, controller: str, kappa: str = "", what: str = "percent-obs"
    ) -> Estimate:
        """Mean over runs."""
        found = self.samples(truth, site, targets, controller, kappa, what)
        return estimate(found[run] for run in sorted(found))

    def lead(self, truth: str, site: str, targets: int, other: str, kappa: str = "") -> Estimate:
        """P minus another, run by run."""
        ours, theirs = self.samples(truth, site, targets, "pomdp"), self.samples(truth, site, targets, other, kappa)
        return estimate(ours[run] - theirs[run] for run in sorted(ours.keys() & theirs.keys()))

    @property
    def panels(self) -> list[Panel]:
        """Truth, site and number of targets of every comparison, in order."""
        return list(dict.fromkeys((t, s, m) for what, t, s, m, c, kappa in self.percent if what == "percent-obs"))

    @property
    def truths(self) -> list[str]:
        """Kinds of truth, in order."""
        return list(dict.fromkeys(truth for truth, _, _ in self.panels))

    @property
    def kappas(self) -> list[str]:
        """Noise per distance of the static cameras that was tried."""
        return sorted({case[5] for case in self.percent if case[5]}, key=float)

    @property
    def runs(self) -> int:
        """How many runs of each case."""
        return len(self.samples(*self.panels[0], "pomdp"))

    def restarts_per_thousand(self, truth: str, site: str, targets: int) -> float:
        """Beliefs of P started anew in a thousand target-steps."""
        case = ("percent-obs", truth, site, targets, "pomdp", "")
        return 1000 * self.restarts[case] / (len(self.percent[case]) * self.steps * targets)


def write_text(path: Path, text: str) -> None:
    """A file that is there in full or not at all."""
    beside = path.with_name(f".{path.name}")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)
