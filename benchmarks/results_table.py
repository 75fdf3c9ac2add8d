"""All runs behind the pages of results, as they stand in figures/runs.csv and figures/sensitivity.csv."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from surveillance_domain.experiments.estimates import Estimate, estimate

RUNS = "runs.csv"
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
        return cls.of(read_rows(path))

    @classmethod
    def of(cls, rows: Iterable[Mapping[str, str]]) -> Results:
        """From at least one row under the names of `Key`, ``percent`` and ``restarts``."""
        percent: dict[Case, dict[int, float]] = {}
        restarts: dict[Case, int] = {}
        for row in rows:
            case = (row["what"], row["truth"], row["site"], int(row["targets"]), row["controller"], row["kappa"])
            percent.setdefault(case, {})[int(row["run"])] = float(row["percent"])
            restarts[case] = restarts.get(case, 0) + int(row["restarts"])
        return cls(percent, restarts, int(row["steps"]), int(row["seed"]))

    def first(self, runs: int) -> Results:
        """Only the runs below a number; restarts are left out."""
        kept = {case: {n: one for n, one in of.items() if n < runs} for case, of in self.percent.items()}
        return replace(self, percent=kept, restarts={})

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

    def lead(self, truth: str, site: str, targets: int, other: str, kappa: str = "", ours: str = "pomdp") -> Estimate:
        """P (or another that is ours) minus another, run by run over the runs that both have."""
        left, right = self.samples(truth, site, targets, ours), self.samples(truth, site, targets, other, kappa)
        return estimate(left[run] - right[run] for run in sorted(left.keys() & right.keys()))

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

    def with_runs_of(self, controller: str, kappa: str = "") -> list[Panel]:
        """The panels in which a controller was run."""
        return [panel for panel in self.panels if ("percent-obs", *panel, controller, kappa) in self.percent]

    def restarts_per_thousand(self, truth: str, site: str, targets: int) -> float:
        """Beliefs of P started anew in a thousand target-steps."""
        case = ("percent-obs", truth, site, targets, "pomdp", "")
        return 1000 * self.restarts[case] / (len(self.percent[case]) * self.steps * targets)


def read_rows(path: Path) -> list[dict[str, str]]:
    """A CSV file by its heads."""
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def write_rows(path: Path, heads: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    """A CSV file, numbers to six digits; it is there in full or not at all."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heads)
    writer.writerows([f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row] for row in rows)
    write_text(path, text.getvalue())


def write_text(path: Path, text: str) -> None:
    """A file that is there in full or not at all."""
    beside = path.with_name(f".{path.name}")
    beside.write_text(text, encoding="utf-8")
    os.replace(beside, path)
