"""A map of a hundred thousand free cells with a hundred targets and twenty cameras, in a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from statistics import median

from benchmarks.report import Report

__all__ = ["large_map"]

SCRIPT = Path(__file__).parents[1] / "tests" / "large_site.py"
_SIDE, _TARGETS, _STEPS = 323, 100, 4


def large_map(quick: bool, seed: int, side: int = _SIDE, targets: int = _TARGETS) -> Report:
    """Build, decide and condition for a few steps; time and peak memory of the whole process."""
    size = (side // 4, targets // 4 or 1) if quick else (side, targets)
    command = [sys.executable, str(SCRIPT), *map(str, size), "pomdp", str(_STEPS)]
    finished = subprocess.run(command, capture_output=True, text=True, check=False)
    if finished.returncode:
        raise RuntimeError(f"the large map failed: {finished.stderr.strip().splitlines()[-1:]}")
    found = json.loads(finished.stdout)
    decision = median(found["decision_ms"][1:])
    rows = [
        ["free cells", f"{found['cells']:,}"],
        ["targets", f"{found['targets']:,}"],
        ["joint actions", f"{found['joint_actions']:.3g}"],
        ["building the model", f"{found['model_s']:.3g} s"],
        ["building the controller", f"{found['controller_s']:.3g} s"],
        ["decision, first", f"{found['decision_ms'][0] / 1000:.3g} s"],
        ["decision, median of the others", f"{decision / 1000:.3g} s"],
        ["choice", found["method"]],
        ["peak memory", f"{found['peak_bytes'] / 1e9:.3g} GB"],
    ]
    return Report("A large map", ["what", "figure"], rows, found)
