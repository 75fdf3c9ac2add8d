"""The exact solver for a fixed horizon, in a process of its own.

pomdp-solve and AI-Toolbox, in C and C++, cannot be installed by pip: their processor seconds stand beside ours as
printed where they were measured, on another machine.
"""

from __future__ import annotations

from typing import Any

from benchmarks.planners import MODELS, in_a_process
from benchmarks.report import Report

__all__ = ["exact"]

CASES = (
    ("cassandra/tiger.95.POMDP", 20, "0.37 s", "0.68 s"),
    ("cassandra/shuttle.95.POMDP", 10, "31 s", "87 s"),
)
_MOST_QUICK = 8


def exact(quick: bool, seed: int) -> Report:
    """Processor time and alpha vectors, of all stages, for each model; quick: fewer steps, with no rival beside."""
    rows: list[list[str]] = []
    figures: dict[str, Any] = {}
    for name, full, pomdp_solve, toolbox in CASES:
        if not (MODELS / name).is_file():
            continue
        horizon = min(full, _MOST_QUICK) if quick else full
        found = in_a_process(name, "exact", horizon, seed)
        figures[f"{name} horizon {horizon}"] = found
        rivals = [pomdp_solve, toolbox] if horizon == full else ["", ""]
        rows.append([name.partition("/")[2], f"{horizon}", *_shown(found), *rivals])
    columns = ["model", "horizon", "value", "vectors, all stages", "processor", "memory", "pomdp-solve", "AI-Toolbox"]
    return Report("Exact, finite horizon", columns, rows, figures, notes=[] if rows else [f"no models at {MODELS}"])


def _shown(found: dict[str, Any]) -> list[str]:
    if "failed" in found:
        return [found["failed"], "", "", ""]
    memory = f"{found['peak_bytes'] / 1e6:,.0f} MB"
    return [f"{found['lower']:.5f}", f"{found['vectors']:,}", f"{found['processor_s']:.3g} s", memory]
