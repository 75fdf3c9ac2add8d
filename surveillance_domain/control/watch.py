"""A watch: a controller on a network of cameras, recorded step by step, with alerts; for hours or for weeks.

What is kept does not grow with the number of steps.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from surveillance_domain.cameras.base import HealthState
from surveillance_domain.control.base import Controller
from surveillance_domain.control.loop import Step, turns
from surveillance_domain.control.record import RecordWriter
from surveillance_domain.world.network import CameraReport, NetworkWorld
from surveillance_domain.world.truth import Truth

__all__ = ["Watch"]

_TIMES = 10_000
"""Of the last decisions, for their median and 99th percentile."""

Alert = Callable[[str, str, str], None]
"""Told camera, state and reason when a camera is lost or returns."""


class Watch:
    """Runs a controller, writes the record, sums up.

    Parameters
    ----------
    world : NetworkWorld
    controller : Controller
    record : RecordWriter, optional
    truth : callable, optional
        The true state, where there is one; goes into the record, and to no controller.
    alert : callable, optional

    Attributes
    ----------
    steps : int
        Done so far.
    failures : dict of str to int
        Steps in which a camera's view was lost, though nobody else had it.
    """

    def __init__(
        self,
        world: NetworkWorld,
        controller: Controller,
        record: RecordWriter | None = None,
        truth: Callable[[], Truth] | None = None,
        alert: Alert | None = None,
    ) -> None:
        self.world, self.controller = world, controller
        self._record, self._truth, self._alert = record, truth, alert
        self._lost: set[str] = set()
        self.steps, self.failures = 0, dict.fromkeys(world.reports, 0)
        self._shares, self._counted, self._seen, self._expected = 0.0, 0, 0, 0.0
        self._decision_ms: deque[float] = deque(maxlen=_TIMES)

    def turns(self) -> Iterator[Step]:
        """The steps, one each time that one is asked for; each is in the record before it is given out."""
        for step in turns(self.world, self.controller):
            self._sum_up(step)
            if self._record is not None:
                self._record.write(self.entry(step))
            self._tell_changes(step)
            yield step

    def entry(self, step: Step) -> dict[str, Any]:
        """A step as the record has it."""
        content = {
            "step": step.number,
            "time_s": round(step.sighting.time_s, 6),
            "sent": dict(step.choice.presets),
            "value": step.choice.value,
            "upper_bound": step.choice.upper_bound,
            "method": step.choice.method,
            "observations": {t: None if c is None else list(c) for t, c in step.sighting.observations.items()},
            "views": dict(step.sighting.views),
            "held": sorted(step.sighting.held),
            "cameras": {name: _told(report) for name, report in self.world.reports.items()},
            "decision_ms": round(step.decision_ms, 4),
            "restarts": self.controller.restarts,
        }
        if self._truth is not None:
            content["truth_m"] = np.round(self._truth().positions_m, 4).tolist()
        return content

    def summary(self) -> dict[str, Any]:
        """PercentObs (where there is a truth), expected and seen number of targets a step, times, cameras."""
        times = np.array(self._decision_ms)
        share = 100 * self._shares / self._counted if self._counted else math.nan
        return {
            "steps": self.steps,
            "percent_obs": share if self._truth is not None and self._counted else None,
            "expected_observed": self._expected / self.steps if self.steps else None,
            "seen": self._seen / self.steps if self.steps else None,
            "restarts": self.controller.restarts,
            "decision_ms": {
                "median": float(np.median(times)) if len(times) else None,
                "p99": float(np.percentile(times, 99)) if len(times) else None,
            },
            "cameras": [
                {"name": name, "state": self._state(name, report), "failures": self.failures[name]}
                for name, report in self.world.reports.items()
            ],
        }

    def _sum_up(self, step: Step) -> None:
        self.steps += 1
        self._seen += step.observed
        self._expected += step.choice.value or 0.0
        if step.present:
            self._shares, self._counted = self._shares + step.observed / step.present, self._counted + 1
        self._decision_ms.append(step.decision_ms)
        for name, view in step.sighting.views.items():
            self.failures[name] += view is None and name not in step.sighting.held

    def _tell_changes(self, step: Step) -> None:
        """A camera is lost when it is left alone by its driver, and returns with its next view."""
        for name, report in self.world.reports.items():
            if name not in self._lost and report.health.state is not HealthState.READY:
                self._lost.add(name)
                self._tell(name, "lost", report.health.because)
            elif name in self._lost and step.sighting.views[name] is not None:
                self._lost.remove(name)
                self._tell(name, "returned", "")

    def _tell(self, camera: str, state: str, because: str) -> None:
        if self._alert is not None:
            self._alert(camera, state, because)

    def _state(self, name: str, report: CameraReport) -> str:
        if name in self._lost or report.health.state is not HealthState.READY:
            return str(report.health.state)
        return report.because if report.because in ("held", "moved by somebody else") else str(report.health.state)


def _told(report: CameraReport) -> dict[str, Any]:
    at = report.position
    return {
        "sent": report.sent,
        "outcome": report.outcome,
        "position": None if at is None else [at.pan, at.tilt, at.zoom],
        "move_s": round(report.move_s, 6),
        "look_s": round(report.look_s, 6),
        "because": report.because,
        "state": str(report.health.state),
        "failures": report.health.failures,
    }
