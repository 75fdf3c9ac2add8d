"""Faults of one camera, alone and in pairs, at random times: the watch goes on, and only that camera's view is lost."""

from __future__ import annotations

import json
import subprocess
import sys
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.control.percent_obs import confidence_interval
from surveillance_domain.world.network import look_budget_s
from tests.emulated_watch import FAULTS, lego

ROOT = Path(__file__).parents[3]
STEPS = 200
BATCH = 25
"""Steps whose mean counts as one sample: what one step sees, the next one mostly sees too."""
LONGEST_S = 1.5 + look_budget_s(lego()) + 2 * 0.02 + 1e-9
"""A step, its look, and twice the grace that is given to a camera that is late."""


def campaigned(camera: str, seed: int, faults: list[str], steps: int = STEPS) -> list[dict[str, Any]]:
    words = [sys.executable, "-m", "tests.fault_campaign", camera, str(steps), str(seed), *faults]
    done = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, timeout=1500, check=False)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def must_hold(camera: str, found: dict[str, Any], absent: dict[str, Any], steps: int = STEPS) -> None:
    assert len(found["seen"]) == len(absent["seen"]) == steps, found["faults"]
    healthy = {name: lost for name, lost in found["lost"].items() if name != camera}
    assert healthy == dict.fromkeys(healthy, 0), found["faults"]
    assert found["lost"][camera] > 0, f"{found['faults']} did nothing"
    assert found["longest_s"] <= LONGEST_S, found["faults"]
    assert found["unnormalised"] <= 1e-9, found["faults"]
    worse = (np.array(found["seen"]) - np.array(absent["seen"])).reshape(-1, BATCH).mean(axis=1).tolist()
    assert confidence_interval(worse)[1] >= 0, f"{found['faults']}: worse than without the camera"


@pytest.mark.end_to_end
def test_each_fault_alone() -> None:
    absent, *found = campaigned("south", 0, list(FAULTS))
    assert len(found) == len(FAULTS)
    for one in found:
        must_hold("south", one, absent)


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("camera", ["north-west", "north-east"])
def test_faults_in_pairs(camera: str) -> None:
    pairs = ["+".join(pair) for pair in combinations(FAULTS, 2)]
    absent, *found = campaigned(camera, 1, pairs)
    for one in found:
        must_hold(camera, one, absent)


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.timeout(1800)
def test_each_fault_alone_in_other_worlds() -> None:
    for seed in range(2, 6):
        absent, *found = campaigned("south", seed, list(FAULTS))
        for one in found:
            must_hold("south", one, absent)
