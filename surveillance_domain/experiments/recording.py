"""A run, recorded step by step for its animation and its table."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from surveillance_domain.control.base import Controller
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.experiments.runs import Run, prepared_run, run_of
from surveillance_domain.experiments.setup import Case, surveillance_of
from surveillance_domain.model.build import Surveillance
from surveillance_domain.pictures.scene import Frame
from surveillance_domain.site.camera import Camera
from surveillance_domain.world.simulated import SimulatedWorld

__all__ = ["Recording", "record_run", "recorded", "write_steps"]


@dataclass(frozen=True, eq=False)
class Recording:
    """A run and all that was seen of it."""

    run: Run
    steps: tuple[Step, ...]
    frames: tuple[Frame, ...]


def record_run(case: Case, number: int) -> Recording:
    """Run ``number`` of a case, recorded; PercentObs is that of `simulate_run`."""
    surveillance = surveillance_of(case.setup)
    world, controller = prepared_run(surveillance, case.controller, case.steps, case.seed, number, case.truth)
    return recorded(surveillance, world, controller, case.steps)


def recorded(surveillance: Surveillance, world: SimulatedWorld, controller: Controller, count: int) -> Recording:
    """A run of ``count`` steps, recorded."""
    steps: list[Step] = []
    frames: list[Frame] = []

    def record(step: Step) -> None:
        steps.append(step)
        observed = np.array([step.sighting.observations[target] is not None for target in surveillance.targets])
        presets = tuple(_number(camera, step.sighting.views[camera.name]) for camera in surveillance.site.cameras)
        positions = np.array(world.truth.positions_m)
        expected = _expected(surveillance, controller)
        frames.append(Frame(step.number, positions, observed, presets, expected, percent_obs(steps)))

    run_loop(world, controller, count, record)
    return Recording(run_of(steps, controller), tuple(steps), tuple(frames))


def write_steps(recording: Recording, path: Path) -> None:
    """A CSV file with one line a step: presets as they were, targets present and observed, PercentObs so far, times."""
    cameras = list(recording.steps[0].sighting.views)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            [
                "step",
                "time_s",
                *cameras,
                "present",
                "observed",
                "percent_obs_so_far",
                "expected_observed",
                "decision_ms",
            ]
        )
        for step, frame in zip(recording.steps, recording.frames, strict=True):
            views = [step.sighting.views[camera] or "" for camera in cameras]
            percent = "" if math.isnan(frame.percent_obs) else f"{frame.percent_obs:.4f}"
            value = "" if step.choice.value is None else f"{step.choice.value:.6f}"
            counts = (step.present, step.observed)
            writer.writerow(
                [step.number, f"{step.sighting.time_s:g}", *views, *counts, percent, value, f"{step.decision_ms:.4f}"]
            )


def _number(camera: Camera, view: str | None) -> int | None:
    return None if view is None else [preset.name for preset in camera.presets].index(view)


def _expected(surveillance: Surveillance, controller: Controller) -> np.ndarray | None:
    """Expected number of targets in each cell; ``None`` for controllers without a belief."""
    if not isinstance(controller, PomdpController):
        return None
    places = np.sum([controller.belief.marginal(f"{target}.location") for target in surveillance.targets], axis=0)
    return np.asarray(places[: surveillance.site.grid.size])
