"""What a night came to, from its record: runs and gaps, outages with cause and mend, restarts, how much was seen."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from surveillance_domain.cameras.base import HealthState, Outcome
from surveillance_domain.cameras.errors import LoginRefused, NotThereInTime, StandsStill
from surveillance_domain.cameras.mending import mend_of
from surveillance_domain.control.continuity import Continuity
from surveillance_domain.world.camera_report import PRIVATE
from surveillance_domain.world.yielding import HELD, MOVED

__all__ = ["Morning", "Series", "Spell"]

_SHORT_STEPS = 2
"""A view that is missing for no longer is counted, not listed."""

_FAULTS = {Outcome.STALLED: StandsStill, Outcome.TIMED_OUT: NotThereInTime}
"""What older records have the outcome only of."""
_ASTRAY = "it looked where no preset of its own is"
_ASTRAY_MEND = "does somebody else move it, or does its pan drift? see surveillance doctor"


@dataclass
class Spell:
    """Steps in a row in which a camera gave no view, or in which people had it.

    Attributes
    ----------
    camera, because, mend : str
    began : datetime
        UTC, when its first step was written.
    first, steps : int
        Number of its first step, and how many.
    began_h : float
        When that was, in the hours of `Series`.
    seconds : float
    over : bool
        Whether it ended before the record did.
    """

    camera: str
    because: str
    mend: str
    began: datetime
    first: int
    began_h: float = 0.0
    steps: int = 1
    seconds: float = 0.0
    over: bool = False


@dataclass(frozen=True)
class Series:
    """What goes into the picture, a number each step.

    Attributes
    ----------
    hours : array of float
        Since the record began.
    seen, expected, present, coverage : array of float
        Targets seen, their expected number, how many there were (or were thought to be), share of the floor in view;
        nan where it is not known.
    """

    hours: array[float] = field(default_factory=lambda: array("d"))
    seen: array[float] = field(default_factory=lambda: array("d"))
    expected: array[float] = field(default_factory=lambda: array("d"))
    present: array[float] = field(default_factory=lambda: array("d"))
    coverage: array[float] = field(default_factory=lambda: array("d"))


class Morning:
    """Sums up a record, line by line.

    Parameters
    ----------
    coverage : callable, optional
        Share of the floor that some views (by camera) see together.

    Attributes
    ----------
    continuity : Continuity
        Its runs, and the times in which nobody watched.
    outages, holds : list of Spell
        In the order in which they began.
    short : dict of str to int
        Views that were missing for a step or two, by camera; mostly cameras that were late.
    restarts : list of dict
        Steps with beliefs that were started anew, and whose.
    cameras : tuple of str
        All that there were.
    unused, beyond : int
        Detections that were not used; sightings beyond the views of the model.
    """

    def __init__(self, coverage: Callable[[Mapping[str, Any]], float] | None = None) -> None:
        self._coverage = coverage
        self.continuity = Continuity()
        self.outages: list[Spell] = []
        self.holds: list[Spell] = []
        self.short: dict[str, int] = {}
        self.restarts: list[dict[str, Any]] = []
        self.series = Series()
        self.steps, self.unused, self.beyond = 0, 0, 0
        self.cameras: tuple[str, ...] = ()
        self._open: dict[tuple[str, bool], Spell] = {}
        self._step_s, self._run = 0.0, ""

    def take(self, line: Mapping[str, Any]) -> None:
        """A header, a step or a closing line, in the record's order."""
        self.continuity.take(line)
        if line["kind"] == "header":
            self._header(line)
        elif line["kind"] == "step":
            self._step(line)

    def end(self, running: bool = False, whole: bool = True) -> None:
        """The record is over; see `Continuity.end`."""
        self.continuity.end(running, whole)
        for key in list(self._open):
            self._close(key, over=False)
        self.outages.sort(key=lambda spell: spell.began)
        self.holds.sort(key=lambda spell: spell.began)

    def _header(self, header: Mapping[str, Any]) -> None:
        if header["run"] == self._run:
            return
        for key in list(self._open):
            self._close(key, over=False)
        self._run, self._step_s = header["run"], float(header["step_s"])

    def _step(self, step: Mapping[str, Any]) -> None:
        self.steps += 1
        self.cameras += tuple(name for name in step["views"] if name not in self.cameras)
        self.unused += step["without_identity"] + step["out_of_view"]
        self.beyond += len(step.get("beyond", ()))  # older records have none
        if step.get("restarted"):
            self.restarts.append({key: step[key] for key in ("step", "written", "restarted")})
        for name, view in step["views"].items():
            held = name in step["held"]
            self._spell((name, True), held, step)
            elsewhere = name in step.get("elsewhere", ())  # older records have none
            self._spell((name, False), view is None and not elsewhere and not held, step)
        self._number(step)

    def _spell(self, key: tuple[str, bool], on: bool, step: Mapping[str, Any]) -> None:
        spell = self._open.get(key)
        if not on:
            if spell is not None:
                self._close(key, over=True)
            return
        if spell is None:
            because, mend = _cause(step["cameras"][key[0]], held=key[1])
            began = datetime.fromisoformat(step["written"])
            hours = self.continuity.hours
            self._open[key] = Spell(key[0], because, mend, began, step["step"], hours, seconds=self._step_s)
        else:
            spell.steps += 1
            spell.seconds += self._step_s
            if not (spell.because if key[1] else spell.mend):
                spell.because, spell.mend = _cause(step["cameras"][key[0]], held=key[1])

    def _close(self, key: tuple[str, bool], over: bool) -> None:
        spell = self._open.pop(key)
        spell.over = over
        if key[1]:
            spell.because = spell.because or HELD
            self.holds.append(spell)
        elif spell.steps <= _SHORT_STEPS and over:
            self.short[key[0]] = self.short.get(key[0], 0) + spell.steps
        else:
            self.outages.append(spell)

    def _number(self, step: Mapping[str, Any]) -> None:
        seen = sum(cell is not None for cell in step["observations"].values()) + len(step["unknown"])
        there = [one for one in step["truth_m"] if one is not None] if "truth_m" in step else step.get("roster")
        series, unknown = self.series, float("nan")
        series.hours.append(self.continuity.hours)
        series.seen.append(seen)
        series.expected.append(unknown if step["value"] is None else step["value"])
        series.present.append(unknown if there is None else len(there))
        series.coverage.append(unknown if self._coverage is None else self._coverage(step))


def _cause(camera: Mapping[str, Any], held: bool) -> tuple[str, str]:
    """Why a camera gave no view, or got no commands, and what would mend that."""
    because = str(camera["because"])
    if held:  # in the step in which it was taken, that is not told yet, and something else may have gone wrong
        return because if because in (HELD, MOVED) else "", ""
    outcome = str(camera["outcome"])
    fault = camera["fault"] or (_FAULTS[Outcome(outcome)].__name__ if outcome in _FAULTS else "")
    if fault:
        locked_out = camera["state"] == HealthState.LOCKED_OUT
        return because or outcome, mend_of(LoginRefused.__name__ if locked_out else fault)
    if because == PRIVATE:
        return because, "turn it to where its picture shows no [[privacy]] polygon"
    if camera["position"] is not None:
        pan, tilt, _ = camera["position"]
        return f"{_ASTRAY}: pan {pan:g}, tilt {tilt:g}", _ASTRAY_MEND
    return because or "no view", ""
