"""How the decision time of the controller `pomdp` grows with the number of targets, on the hall."""

from __future__ import annotations

from statistics import median

import numpy as np

from benchmarks.hall import Hall
from benchmarks.report import Report, milliseconds
from benchmarks.timing import in_turns
from surveillance_domain.experiments.runs import simulate_run

__all__ = ["growth"]

COUNTS = (1, 3, 10, 30, 100, 300, 1000, 3000, 10_000)
FITTED_FROM = 100
_MOST_QUICK = 1000


def growth(quick: bool, seed: int, counts: tuple[int, ...] = COUNTS, site: str = "hall") -> Report:
    """Decision time (predict, choose, condition) with dense beliefs, and along simulated runs.

    A simulated run's decisions are the loop's own measurement; the first step, which may compile, does not count.
    """
    dense, simulated = {}, {}
    for targets in counts:
        if quick and targets > _MOST_QUICK:
            continue
        hall = Hall.of(targets, np.random.default_rng(seed), site)
        turns = 3 if targets > 300 else 30
        timed = in_turns({"decision": hall.decided}, turns, 1.0 if quick else 4.0)["decision"]
        dense[targets] = timed.median
        steps = 5 if quick or targets > 100 else 50
        run = simulate_run(hall.surveillance, "pomdp", steps + 1, seed, 0)
        simulated[targets] = median(run.decision_ms[1:]) / 1000
    rows = [
        [f"{m:,}", milliseconds(dense[m]), f"{1e6 * dense[m] / m:,.1f} µs", milliseconds(simulated[m])] for m in dense
    ]
    exponents = {"dense": _slope(dense), "simulated": _slope(simulated)}
    note = ", ".join(f"m^{slope:.2f} {name}" for name, slope in exponents.items() if slope is not None)
    return Report(
        f"Decision time of pomdp on {site}",
        ["targets", "dense beliefs", "for each target", "along a simulated run"],
        rows,
        {"dense_seconds": dense, "simulated_seconds": simulated, "exponents": exponents},
        notes=[f"growth from m = {FITTED_FROM}: {note}"] if note else [],
    )


def _slope(seconds: dict[int, float]) -> float | None:
    """Exponent of a power law fitted to the larger counts."""
    fitted = {m: s for m, s in seconds.items() if m >= FITTED_FROM}
    if len(fitted) < 2:
        return None
    return float(np.polyfit(np.log(list(fitted)), np.log(list(fitted.values())), 1)[0])
