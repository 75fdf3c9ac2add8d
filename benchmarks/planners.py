"""Offline planners on the published models: time to a gap, and bounds after equal time, each in a process of its own.

The peers are what pip installs (extra ``bench``). pomdp-toolkit's HSVI gives a value from below; pomdp_py has value
iteration over whole policy trees, for a horizon that it can bear, and POUCT, whose estimate is no bound. SARSOP, in
C++, cannot be installed by pip: its processor seconds stand beside ours as printed where they were measured, on another
machine.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from benchmarks.report import Report

__all__ = ["MODELS", "in_a_process", "planners"]

MODELS = Path(__file__).parents[1] / ".." / "shared" / "data" / "pomdp"
CASES = (
    ("cassandra/tiger.95.POMDP", 20.0, "0.01 s to 1e-3"),
    ("cassandra/cheese.95.POMDP", 20.0, "0.01 s to 1e-3"),
    ("cassandra/shuttle.95.POMDP", 20.0, "0.01 s to 1e-3"),
    ("cassandra/4x3.95.POMDP", 20.0, "0.76 s to 1e-3"),
    ("rocksample", 20.0, "0.32 s to 1e-3"),
    ("cassandra/Hallway.pomdp", 1.0, "[0.886, 1.224] after 1 s"),
    ("cassandra/Hallway.pomdp", 10.0, "[0.971, 1.219] after 10 s"),
    ("cassandra/Hallway.pomdp", 60.0, "[0.995, 1.206] after 120 s"),
)
PEERS = ("ours", "pomdp-toolkit", "pomdp_py POUCT", "pomdp_py value iteration")
_MOST_QUICK = 10.0
_GRACE_S = 60.0
"""For loading, compiling and reading the model; who does not stop by then is ended."""


def planners(
    quick: bool, seed: int, cases: tuple[tuple[str, float, str], ...] = CASES, peers: tuple[str, ...] = PEERS
) -> Report:
    """Every planner on every model, with a time limit."""
    rows: list[list[str]] = []
    figures: dict[str, Any] = {}
    for name, limit, sarsop in cases:
        if ("/" in name and not (MODELS / name).is_file()) or (quick and limit > _MOST_QUICK and "Hallway" in name):
            continue
        for peer in peers:
            found = in_a_process(name, peer, min(limit, _MOST_QUICK) if quick else limit, seed)
            figures[f"{name} {limit:g} s {peer}"] = found
            rows.append([Path(name).name, f"{limit:g} s", peer, *_shown(found), sarsop if peer == PEERS[0] else ""])
    columns = ["model", "limit", "planner", "lower", "upper", "stopped after", "processor", "memory", "SARSOP"]
    notes = ["to a gap of 1e-3 or the limit; a figure after ≈ is an estimate, no bound; memory of the whole process"]
    return Report("Offline planners", columns, rows, figures, notes=notes if rows else [f"no models at {MODELS}"])


def _shown(found: dict[str, Any]) -> list[str]:
    if "failed" in found:
        return [found["failed"], "", "", "", ""]
    estimate = "≈ " if found.get("estimate") else ""
    upper = "" if found["upper"] is None else f"{found['upper']:.5f}"
    took = [f"{found['seconds']:.3g} s", f"{found['processor_s']:.3g} s", f"{found['peak_bytes'] / 1e6:,.0f} MB"]
    lower = found.get("remark", "") if found["lower"] is None else f"{estimate}{found['lower']:.5f}"
    return [lower, upper, *took]


def in_a_process(name: str, peer: str, limit: float, seed: int) -> dict[str, Any]:
    """What a planner found on a published model or a domain, as `benchmarks.planner_peers` prints it."""
    model = str(MODELS / name) if "/" in name else name
    command = [sys.executable, "-m", "benchmarks.planner_peers", model, peer, str(limit), str(seed)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=limit + _GRACE_S)
    except subprocess.TimeoutExpired:
        return {"failed": f"no answer within {limit + _GRACE_S:g} s"}
    if done.returncode:
        return {"failed": done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "failed without a word"}
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer
