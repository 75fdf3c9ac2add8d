"""Time to a gap, and gaps after a time, of the point-based solver on the published models.

Prints one line a model: bounds, wall and processor seconds, memory of the process. Beside it stands what the C++ solver
SARSOP needed on a machine like the one that the figures were first measured on (processor seconds).
"""

from __future__ import annotations

import resource
import sys
import time
from pathlib import Path

import factored_pomdp as fp
from solvers import Limits, PointBased

MODELS = Path(__file__).parents[1] / ".." / "shared" / "data" / "pomdp" / "cassandra"

CASES = (
    ("tiger.95.POMDP", 60.0, "0.01 s to 1e-3"),
    ("cheese.95.POMDP", 60.0, "0.01 s to 1e-3"),
    ("shuttle.95.POMDP", 60.0, "0.01 s to 1e-3"),
    ("4x3.95.POMDP", 60.0, "0.76 s to 1e-3"),
    ("Hallway.pomdp", 1.0, "[0.886, 1.224] after 1 s"),
    ("Hallway.pomdp", 10.0, "[0.971, 1.219] after 10 s"),
)


def main() -> None:
    """Run every case once; the first solve of all compiles and is not counted."""
    if not MODELS.is_dir():
        sys.exit(f"the published models are not at {MODELS}")
    PointBased(fp.domain("tiger")).solve(Limits(precision=1.0))
    print(f"{'model':20} {'lower':>9} {'upper':>9} {'wall s':>8} {'cpu s':>8} {'MB':>6}  SARSOP")
    for name, seconds, other in CASES:
        solver = PointBased(fp.load(MODELS / name))
        start = time.process_time()
        found = solver.solve(Limits(precision=1e-3, time_limit=seconds))
        used, held = time.process_time() - start, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024
        print(f"{name:20} {found.lower:9.5f} {found.upper:9.5f} {found.seconds:8.3f} {used:8.3f} {held:6d}  {other}")


if __name__ == "__main__":
    main()
