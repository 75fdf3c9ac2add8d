"""Large maps: twenty cameras (3.5 billion joint presets), memory bounded, nothing quadratic in cells."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]


@cache
def measured(side: int, targets: int, controller: str, steps: int) -> dict[str, Any]:
    """In a process of its own, whose peak memory is then its own too."""
    command = [sys.executable, str(ROOT / "tests" / "large_site.py"), *map(str, (side, targets, controller, steps))]
    # One thread: those of the linear algebra library wait for each other where another process holds a core.
    alone = os.environ | {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    done = subprocess.run(command, cwd=ROOT, env=alone, capture_output=True, text=True, timeout=280, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@pytest.mark.end_to_end
def test_ten_thousand_cells_are_controlled_in_little_memory():
    found = measured(105, 20, "pomdp", 3)
    assert found["cells"] >= 10_000
    assert found["joint_actions"] == 3**20
    # One table of cells by cells would hold 10,000 x 10,000 doubles: 0.9 GB.
    assert found["peak_bytes"] < 600e6
    assert found["restarts"] == 0
    assert 0 < found["value"] <= found["upper_bound"] <= 20
    assert "lazy greedy" in found["method"]
    assert ("not proved" in found["method"]) == (found["upper_bound"] > found["value"] * (1 + 1e-9))


@pytest.mark.end_to_end
@pytest.mark.parametrize("controller", ["mp", "stat"])
def test_the_other_controllers_take_it_too(controller):
    found = measured(105, 20, controller, 2)
    assert found["peak_bytes"] < 600e6
    assert len(found["observed"]) == 2


@pytest.mark.end_to_end
@pytest.mark.slow
def test_a_hundred_thousand_cells_and_a_hundred_targets_take_bounded_memory():
    """A belief is 100,000 cells x 8 directions x 100 targets: 0.67 GB; prediction and posterior are two more."""
    found = measured(330, 100, "pomdp", 2)
    assert found["cells"] >= 100_000
    assert found["peak_bytes"] < 4.5e9
    assert found["restarts"] == 0
    assert 0 < found["value"] <= found["upper_bound"] <= 100
