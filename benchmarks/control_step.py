"""What a control step costs apart from turning and settling: the decision, and HTTP with emulated cameras.

Cameras are emulated in virtual time, in which turning and settling take none, so the time on the wall is what is left:
prediction, choice, conditioning, and every question to every camera, answered in this very process.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from statistics import median
from time import perf_counter

import numpy as np

from benchmarks.report import Aim, Report, milliseconds
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.loop import turns
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.emulation.truth_eyes import TruthEyes
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.build import surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.world.network import NetworkWorld

__all__ = ["control_step"]

COUNTS = (3, 20)
_AIM_MS = 50.0
_TARGETS = 5


def control_step(quick: bool, seed: int, counts: tuple[int, ...] = COUNTS) -> Report:
    """Median and 99th percentile of a step's overhead, by number of cameras, five targets."""
    rows, figures, aims = [], {}, []
    for count in counts:
        steps_s, decisions_ms, questions = _measured(_with_cameras(count), 20 if quick else 100, seed)
        whole, late = median(steps_s), float(np.percentile(steps_s, 99))
        decision = median(decisions_ms) / 1000
        figures[count] = {"step_s": whole, "p99_s": late, "decision_s": decision, "questions_a_step": questions}
        http = milliseconds(whole - decision)
        rows.append(
            [f"{count}", milliseconds(whole), milliseconds(late), milliseconds(decision), http, f"{questions:.1f}"]
        )
        if count == COUNTS[0]:
            aims.append(Aim(f"{count} cameras: milliseconds a step", 1000 * whole, _AIM_MS))
    return Report(
        "Control step on emulated cameras, apart from turning and settling",
        ["cameras", "step, median", "99th percentile", "decision", "HTTP and the rest", "questions a step"],
        rows,
        figures,
        aims,
        ["both sides of HTTP run in this process, and share its processor"],
    )


def _with_cameras(count: int) -> Site:
    """The lego site with its cameras over and over, under other names."""
    site = load_site("lego")
    mine = site.cameras
    cameras = [mine[k % len(mine)].model_copy(update={"name": f"camera {k + 1}"}) for k in range(count)]
    return replace(site, cameras=tuple(cameras))


def _measured(site: Site, steps: int, seed: int) -> tuple[list[float], list[float], float]:
    """Seconds of each step, milliseconds of each decision, questions a step; the first steps may compile."""
    clock = VirtualClock()
    for_truth, for_eyes, for_retries = np.random.default_rng(seed).spawn(3)
    with EmulatedSite(site, _TARGETS, clock, for_truth) as emulation:
        surveillance = surveillance_model(emulation.site, _TARGETS)
        cameras = emulation.open_cameras(for_retries)
        world = NetworkWorld(emulation.site, cameras, TruthEyes(surveillance, emulation, for_eyes), clock)
        try:
            world.start(10.0)
            loop = turns(world, make_controller("pomdp", surveillance, Setting(open_roster=True)))
            for _ in islice(loop, 3):
                pass
            asked = sum(camera.questions for camera in emulation.cameras.values())
            steps_s, decisions_ms = [], []
            for _ in range(steps):
                started = perf_counter()
                decisions_ms.append(next(loop).decision_ms)
                steps_s.append(perf_counter() - started)
            asked = sum(camera.questions for camera in emulation.cameras.values()) - asked
        finally:
            world.close()
    return steps_s, decisions_ms, asked / steps
