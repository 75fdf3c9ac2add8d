"""A large map with random obstacles and twenty cameras; run as a script it measures one controller on it.

``python tests/large_site.py SIDE TARGETS CONTROLLER STEPS`` prints one JSON object: free cells, seconds, peak memory.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from time import perf_counter

import numpy as np

from benchmarks.machine import peak_bytes
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.loop import run_loop
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import surveillance_model
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site

__all__ = ["large_site"]


def large_site(side: int, seed: int = 0) -> Site:
    """``side`` x ``side`` cells of a metre, blocks of 1 to 5 cells strewn over it, 5 x 4 cameras of three presets."""
    rng = np.random.default_rng(seed)
    free = np.ones((side, side), dtype=bool)
    for _ in range(side * side // 250):
        (x, y), (width, height) = rng.integers(0, side, 2), rng.integers(1, 6, 2)
        free[y : y + height, x : x + width] = False
    base = load_site("tiny")
    cameras = []
    for number in range(20):
        x, y = side * (number % 5 + 0.5) / 5, side * (number // 5 + 0.5) / 4
        free[int(y) - 4 : int(y) + 5, int(x) - 4 : int(x) + 5] = True
        presets = [{"name": str(pan), "pan": pan, "tilt": -30.0, "zoom": 1} for pan in (-60.0, 0.0, 60.0)]
        own = {
            "name": f"camera {number}",
            "mount": {"position_m": (x, y, 4.0), "yaw_deg": float(rng.uniform(0, 360))},
            "max_depth_m": 40.0,
            "zoom_hfov": ((1, 60.0),),
            "presets": presets,
        }
        cameras.append(Camera.model_validate({**base.cameras[0].model_dump(), **own}))
    return replace(base, name="large", grid=Grid(free, 1.0), cameras=tuple(cameras))


def measured(side: int, targets: int, controller: str, steps: int) -> dict[str, object]:
    """Build, decide, condition; what it took."""
    started = perf_counter()
    built = surveillance_model(large_site(side), targets)
    modelled = perf_counter()
    world = simulated_world(built, "grid", 0, 0)
    chosen = make_controller(controller, built, Setting(world, steps))
    ready = perf_counter()
    record = run_loop(world, chosen, steps)
    last = record[-1].choice
    return {
        "cells": built.site.grid.size,
        "targets": targets,
        "joint_actions": built.model.joint_actions,
        "model_s": round(modelled - started, 3),
        "controller_s": round(ready - modelled, 3),
        "decision_ms": [round(step.decision_ms, 1) for step in record],
        "observed": [step.observed for step in record],
        "value": last.value,
        "upper_bound": last.upper_bound,
        "method": last.method,
        "restarts": chosen.restarts,
        "peak_bytes": peak_bytes(),
    }


if __name__ == "__main__":
    print(json.dumps(measured(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], int(sys.argv[4]))))
