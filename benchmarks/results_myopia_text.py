"""The section of docs/results.md on the price of being myopic, worked out from figures/price.csv and lookahead.csv."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any, NamedTuple, get_type_hints

from results_text import fill

from surveillance_domain.experiments.estimates import Estimate, estimate

__all__ = ["HEADING", "LOOKAHEAD", "PRICE", "HallRun", "PriceRun", "section"]

PRICE, LOOKAHEAD = "price.csv", "lookahead.csv"
HEADING = "## The price of being myopic"
NAMES = {"pomdp": "P (one step)", "lookahead": "lookahead (5 steps)", "full-information": "full information"}
ROOMS = {"room": "quick", "room-slow": "slow"}
HALLS = {"hall": "quick", "hall-slow": "slow"}
VERDICTS = {1: "gains", 0: "changes nothing that could be measured", -1: "**loses**"}


class PriceRun(NamedTuple):
    """By how much one run of a policy fell short of the solution, whose bounds stand beside it."""

    room: str
    policy: str
    run: int
    shortfall: float
    lower: float
    upper: float
    discount: float
    steps: int
    seed: int


class HallRun(NamedTuple):
    """PercentObs of a run in the hall."""

    site: str
    targets: int
    controller: str
    run: int
    percent: float
    steps: int
    seed: int


def section(figures: Path) -> str:
    """The section; nothing where it was not measured."""
    if not all((figures / name).exists() for name in (PRICE, LOOKAHEAD)):
        return ""
    rooms = [PriceRun._make(_typed(PriceRun, row)) for row in _rows(figures / PRICE)]
    halls = [HallRun._make(_typed(HallRun, row)) for row in _rows(figures / LOOKAHEAD)]
    return "\n\n".join([HEADING, *_exact(rooms), *_hall(halls)]) + "\n"


def _rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def _typed(kind: type[PriceRun] | type[HallRun], row: dict[str, str]) -> list[Any]:
    return [read(row[name]) for name, read in get_type_hints(kind).items()]


def _exact(runs: list[PriceRun]) -> list[str]:
    """One target in a small room: what the optimal policy has over one that looks less far."""
    first = runs[0]
    rest = first.discount**first.steps / (1 - first.discount)
    count = len({run.run for run in runs})
    said = f"""Made by `python benchmarks/results_myopia.py`. One target in a room of 20 cells with 4 directions (80
    states; `benchmarks/sites/room.toml`, and `room-slow.toml`, whose cameras reach only the next preset in a step),
    discount {first.discount:g}, solved by `point-based`: the optimal value at the start lies between *lower* and
    *upper*. The *price* of a policy is the optimal value minus the policy's own. How far it falls short of *lower* is
    estimated from {count} runs of {first.steps} steps (seed {first.seed}) by the sum of its steps' disadvantages, which
    has the same mean as the difference of returns and a small part of its noise. The price's interval holds the 95 %
    interval of that estimate, the gap between the bounds, and what later steps could change ({rest:.3f}). In *points*
    the price is divided by the value of always seeing the target, {1 / (1 - first.discount):g}."""
    lines = [
        "| cameras | lower | upper | policy | short of lower | price | in points |",
        "|---|---:|---:|---|---:|---:|---:|",
    ]
    told = []
    for room, pace in ROOMS.items():
        here = [run for run in runs if run.room == room]
        for policy in dict.fromkeys(run.policy for run in here):
            own = estimate(run.shortfall for run in here if run.policy == policy)
            lower, upper = here[0].lower, here[0].upper
            low, high = max(0.0, own.low - rest), max(0.0, own.high + upper - lower + rest)
            points = 100 * (1 - first.discount)
            cells = [pace, f"{lower:.3f}", f"{upper:.3f}", NAMES[policy], f"{own.mean:.3f} ± {own.half_width:.3f}"]
            cells += [f"{low:.3f} to {high:.3f}", f"{points * low:.2f} to {points * high:.2f}"]
            lines.append("| " + " | ".join(cells) + " |")
            told.append(_priced(pace, NAMES[policy], low, high, points))
    return [fill(said), "\n".join(lines), fill(" ".join(told))]


def _priced(pace: str, policy: str, low: float, high: float, points: float) -> str:
    if low == 0.0:
        return f"With {pace} cameras {policy} costs at most {points * high:.2f} points, perhaps nothing."
    return f"With {pace} cameras {policy} costs {points * low:.2f} to {points * high:.2f} points."


def _hall(runs: list[HallRun]) -> list[str]:
    """The lookahead against P in the hall."""
    first = runs[0]
    counts = list(dict.fromkeys(run.targets for run in runs))
    said = f"""In the hall (PercentObs, grid truth, {len({run.run for run in runs})} runs of {first.steps} steps, seed
    {first.seed}; differences are paired, run by run) with quick cameras, and with slow ones that reach only the
    neighbouring preset in a step (`benchmarks/sites/hall-slow.toml`). The lookahead compares up to 8 first actions over
    5 steps in up to 32 simulated scenarios. Full information looks one step ahead, so it bounds nothing where cameras
    are slow."""
    heads = ["cameras", "m", "P", "lookahead", "lookahead − P", "full information − P"]
    lines = ["| " + " | ".join(heads) + " |", "|---|" + "---:|" * (len(heads) - 1)]
    told = []
    for site, pace in HALLS.items():
        for count in counts:
            of = {name: _percent(runs, site, count, name) for name in NAMES}
            gain, known = (_paired(of[name], of["pomdp"]) for name in ("lookahead", "full-information"))
            means = [estimate(of[name].values()) for name in ("pomdp", "lookahead")]
            cells = [pace, str(count), *(f"{mean.mean:.1f} ± {mean.half_width:.1f}" for mean in means)]
            cells += [f"{gap.mean:+.1f} ± {gap.half_width:.1f}" for gap in (gain, known)]
            lines.append("| " + " | ".join(cells) + " |")
            told.append(f"{pace}, m = {count}: the lookahead {VERDICTS[gain.verdict]} ({gain.mean:+.1f})")
    return [fill(said), "\n".join(lines), fill("; ".join(told).capitalize() + ".")]


def _percent(runs: list[HallRun], site: str, targets: int, controller: str) -> dict[int, float]:
    wanted = (site, targets, controller)
    return {run.run: run.percent for run in runs if (run.site, run.targets, run.controller) == wanted}


def _paired(ours: dict[int, float], theirs: dict[int, float]) -> Estimate:
    return estimate(ours[run] - theirs[run] for run in sorted(ours.keys() & theirs.keys()))
