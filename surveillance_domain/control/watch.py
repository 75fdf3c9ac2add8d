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
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.record import RecordWriter
from surveillance_domain.world.camera_report import CameraReport
from surveillance_domain.world.network import NetworkWorld
from surveillance_domain.world.truth import OUTSIDE, Truth
from surveillance_domain.world.yielding import HELD, MOVED

__all__ = ["NO_VIEW", "THE_RECORD", "Alert", "Watch"]

_TIMES = 10_000
"""Of the last decisions, for their median and 99th percentile."""
_LOST_S = 30.0
"""After so long without a view a camera counts as lost, even though it answers."""
NO_VIEW = "no view"
THE_RECORD = "the record"
"""Told of like a camera when it cannot be written."""

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
    last_faults : dict of str to (int, str)
        For cameras that lost views: the number of the last such step, and why.
    unrecorded : int
        Steps that could not be written to the record.
    unrecorded_because : str
        Why the last of them could not.
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
        self._seen_last: dict[str, float] = {}
        self.steps, self.unrecorded, self.failures = 0, 0, dict.fromkeys(world.reports, 0)
        self.unrecorded_because = ""
        self.last_faults: dict[str, tuple[int, str]] = {}
        self._shares, self._counted, self._seen, self._beyond, self._expected = 0.0, 0, 0, 0, 0.0
        self._unused = {"without_identity": 0, "out_of_view": 0}
        self._decision_ms: deque[float] = deque(maxlen=_TIMES)

    def turns(self) -> Iterator[Step]:
        """The steps, one each time that one is asked for; each is in the record before it is given out."""
        for step in turns(self.world, self.controller):
            self._sum_up(step)
            self._write(step)
            self._tell_changes(step)
            yield step

    def end(self, how: str, because: str) -> None:
        """Close the record with how the run ended, in a word and in words; after this nothing is recorded."""
        if self._record is None:
            return
        record, self._record = self._record, None
        try:
            record.end({"how": how, "because": because, "steps": self.steps, "unrecorded": self.unrecorded})
        except OSError as problem:
            self._change(THE_RECORD, True, (problem.strerror or str(problem)).lower())

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
            "unknown": {name: list(cell) for name, cell in step.sighting.unknown.items()},
            "without_identity": step.sighting.without_identity,
            "out_of_view": step.sighting.out_of_view,
            "beyond": dict(step.sighting.beyond),
            "views": dict(step.sighting.views),
            "elsewhere": {name: list(place) for name, place in step.sighting.elsewhere.items()},
            "through": dict(step.sighting.through),
            "private": sorted(step.sighting.private),
            "held": sorted(step.sighting.held),
            "cameras": {name: _told(report) for name, report in self.world.reports.items()},
            "decision_ms": round(step.decision_ms, 4),
            "restarts": self.controller.restarts,
            "late": self.world.late,
        }
        if isinstance(self.controller, PomdpController):
            content |= {"restarted": list(self.controller.restarted), "roster": list(self.controller.targets)}
        if self._truth is not None:
            places = np.round(self._truth().positions_m, 4)
            content["truth_m"] = [place.tolist() if np.isfinite(place).all() else None for place in places]
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
            "seen_beyond": self._beyond / self.steps if self.steps else None,
            "restarts": self.controller.restarts,
            "late": self.world.late,
            "unrecorded": self.unrecorded,
            "unrecorded_because": self.unrecorded_because,
            **self._unused,
            "roster": self._roster_summary(),
            "decision_ms": {
                "median": float(np.median(times)) if len(times) else None,
                "p99": float(np.percentile(times, 99)) if len(times) else None,
            },
            "cameras": [
                {"name": name, "state": self._state(name, report), "failures": self.failures[name]}
                for name, report in self.world.reports.items()
            ],
        }

    def _roster_summary(self) -> dict[str, Any] | None:
        if not isinstance(self.controller, PomdpController) or self.controller.roster is None:
            return None
        roster = self.controller.roster
        return {"now": list(self.controller.targets), "started": roster.started, "ended": roster.ended}

    def _sum_up(self, step: Step) -> None:
        self.steps += 1
        self._seen, self._beyond = self._seen + step.observed, self._beyond + step.beyond
        self._expected += step.choice.value or 0.0
        self._unused["without_identity"] += step.sighting.without_identity
        self._unused["out_of_view"] += step.sighting.out_of_view
        present = step.present if self._truth is None else int((self._truth().cells != OUTSIDE).sum())
        if present:
            self._shares, self._counted = self._shares + step.observed / present, self._counted + 1
        self._decision_ms.append(step.decision_ms)
        for name in step.sighting.views:
            if name not in step.sighting.looking and name not in step.sighting.held:
                self.failures[name] += 1
                self.last_faults[name] = step.number, self.world.reports[name].because or NO_VIEW

    def _write(self, step: Step) -> None:
        """A record that cannot be written does not stop a watch; it is told of, and tried again."""
        if self._record is None:
            return
        try:
            self._record.write(self.entry(step))
        except OSError as problem:
            self.unrecorded += 1
            self.unrecorded_because = (problem.strerror or str(problem)).lower()
            self._change(THE_RECORD, True, self.unrecorded_because)
        else:
            self._change(THE_RECORD, False)

    def _tell_changes(self, step: Step) -> None:
        """A camera is lost when its driver leaves it alone, or when it gives no view for long; a view is its return."""
        now = step.sighting.time_s
        for name, report in self.world.reports.items():
            if name in step.sighting.looking or name in step.sighting.held:
                self._seen_last[name] = now
            away = report.health.state is not HealthState.READY
            if away or now - self._seen_last.setdefault(name, now) >= _LOST_S:
                self._change(name, True, report.health.because if away else report.because or "no view")
            elif name in step.sighting.looking:
                self._change(name, False)

    def _change(self, name: str, lost: bool, because: str = "") -> None:
        if lost and name not in self._lost:
            self._lost.add(name)
            self._tell(name, "lost", because)
        elif not lost and name in self._lost:
            self._lost.remove(name)
            self._tell(name, "returned", "")

    def _tell(self, camera: str, state: str, because: str) -> None:
        if self._alert is not None:
            self._alert(camera, state, because)

    def _state(self, name: str, report: CameraReport) -> str:
        if report.health.state is not HealthState.READY:
            return str(report.health.state)
        if report.because in (HELD, MOVED):
            return report.because
        return NO_VIEW if name in self._lost else str(report.health.state)


def _told(report: CameraReport) -> dict[str, Any]:
    at = report.position
    return {
        "sent": report.sent,
        "outcome": report.outcome,
        "position": None if at is None else [at.pan, at.tilt, at.zoom],
        "move_s": round(report.move_s, 6),
        "look_s": round(report.look_s, 6),
        "because": report.because,
        "fault": report.fault,
        "state": str(report.health.state),
        "failures": report.health.failures,
    }
