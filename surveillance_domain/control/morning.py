"""What a night came to: outages with cause and mend, held cameras, restarts, and how much was seen, from its record."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from surveillance_domain.cameras.base import HealthState, Outcome
from surveillance_domain.cameras.errors import LoginRefused
from surveillance_domain.cameras.mending import mend_of
from surveillance_domain.world.yielding import HELD, MOVED

__all__ = ["Morning", "Series", "Spell"]

_SHORT_STEPS = 2
"""A view that is missing for no longer is counted, not listed."""

_OUTCOMES = {
    Outcome.STALLED: "is something in its way, does somebody else command it, or is its read-back wrong? restart it",
    Outcome.TIMED_OUT: "its moves take longer than the site says (pan_deg_per_s, tilt_deg_per_s, zoom_per_s, settle_s; "
    "or make step_s longer), or its read-back stands still: restart it",
}
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
        Since the record began, by the watch's own clock; runs one after the other.
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
    runs : list of dict
        Their headers.
    outages, holds : list of Spell
    short : dict of str to int
        Views that were missing for a step or two, by camera; mostly cameras that were late.
    restarts : list of dict
        Steps with beliefs that were started anew, and whose.
    cameras : tuple of str
        All that there were.
    unused, beyond : int
        Detections that were not used; sightings beyond the views of the model.
    """

    def __init__(self, coverage: Callable[[Mapping[str, str | None]], float] | None = None) -> None:
        self._coverage = coverage
        self.runs: list[dict[str, Any]] = []
        self.outages: list[Spell] = []
        self.holds: list[Spell] = []
        self.short: dict[str, int] = {}
        self.restarts: list[dict[str, Any]] = []
        self.series = Series()
        self.steps, self.unused, self.beyond = 0, 0, 0
        self.cameras: tuple[str, ...] = ()
        self._open: dict[tuple[str, bool], Spell] = {}
        self._offset_s, self._last_s, self._step_s, self._run = 0.0, 0.0, 0.0, ""

    def take(self, line: Mapping[str, Any]) -> None:
        """A header or a step, in the record's order."""
        if line["kind"] == "header":
            self._header(line)
        else:
            self._step(line)

    def end(self) -> None:
        """The record is over."""
        for key in list(self._open):
            self._close(key, over=False)

    def _header(self, header: Mapping[str, Any]) -> None:
        if header["run"] == self._run:
            return
        for key in list(self._open):
            self._close(key, over=False)
        self._run, self._step_s = header["run"], float(header["step_s"])
        self._offset_s, self._last_s = self._offset_s + self._last_s, 0.0
        self.runs.append(dict(header))

    def _step(self, step: Mapping[str, Any]) -> None:
        self.steps += 1
        self._last_s = float(step["time_s"])
        self.cameras += tuple(name for name in step["views"] if name not in self.cameras)
        self.unused += step["without_identity"] + step["out_of_view"]
        self.beyond += len(step.get("beyond", ()))  # older records have none
        if step.get("restarted"):
            self.restarts.append({key: step[key] for key in ("step", "written", "restarted")})
        for name, view in step["views"].items():
            held = name in step["held"]
            self._spell((name, True), held, step)
            self._spell((name, False), view is None and not held, step)
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
            began_h = (self._offset_s + self._last_s) / 3600
            self._open[key] = Spell(key[0], because, mend, began, step["step"], began_h, seconds=self._step_s)
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
        series.hours.append((self._offset_s + self._last_s) / 3600)
        series.seen.append(seen)
        series.expected.append(unknown if step["value"] is None else step["value"])
        series.present.append(unknown if there is None else len(there))
        series.coverage.append(unknown if self._coverage is None else self._coverage(step["views"]))


def _cause(camera: Mapping[str, Any], held: bool) -> tuple[str, str]:
    """Why a camera gave no view, or got no commands, and what would mend that."""
    because = str(camera["because"])
    if held:  # in the step in which it was taken, that is not told yet, and something else may have gone wrong
        return because if because in (HELD, MOVED) else "", ""
    if camera["fault"]:
        locked_out = camera["state"] == HealthState.LOCKED_OUT
        return because, mend_of(LoginRefused.__name__ if locked_out else camera["fault"])
    if camera["outcome"] in _OUTCOMES:
        return because or str(camera["outcome"]), _OUTCOMES[Outcome(camera["outcome"])]
    if camera["position"] is not None:
        pan, tilt, _ = camera["position"]
        return f"{_ASTRAY}: pan {pan:g}, tilt {tilt:g}", _ASTRAY_MEND
    return because or "no view", ""
