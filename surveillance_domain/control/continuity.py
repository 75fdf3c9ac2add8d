"""Whether anybody watched: the runs of a record, when each began, how it ended, and the gaps within and between them.

Times are those of the clock on the wall at which steps were written, for a watch's own clock stands still while a
computer sleeps; only runs in virtual time go by their own.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

__all__ = ["Continuity", "Gap", "RunSpan"]

_FEW_STEPS = 5.0
"""So much more than the pace of a watch is a gap."""
_TWICE = 2.0
"""So much longer than the steps that are missing from the record would have taken, too."""

_KILLED = "ended without closing: killed, crashed or power lost"
_UNKNOWN = "how it ended is not in its record, which is of an older version"
_ELSEWHERE = "how it ended is not in this file of its record"
_RUNNING = "it is still there"
_STOOD_STILL = "the run stood still: stopped, hung, or the computer had too much to do"
_SLEPT = "the computer slept, or its clock was set"
_MEND_KILLED = "let systemd start it again (examples/surveillance.service); journalctl says what ended it"
_MEND_STOPPED = "it was stopped as asked: start it again, or let systemd do so"
_MEND_STOOD_STILL = "give it a computer of its own; with WatchdogSec systemd starts again what hangs"
_MEND_SLEPT = "forbid the computer to sleep (systemctl mask sleep.target), and let it keep its time by NTP"


@dataclass
class RunSpan:
    """A run of a record, in one file or several.

    Attributes
    ----------
    header : dict
    steps : int
        Recorded ones.
    began : datetime
        UTC.
    last : datetime or None
        When its last step was recorded.
    ended : datetime or None
        When its closing line was written.
    how : str
        ``steps``, ``until``, ``stopped``, ``error``; ``killed`` without a closing line; ``running``; ``unknown``.
    because : str
        The same in words.
    """

    header: dict[str, Any]
    began: datetime
    steps: int = 0
    last: datetime | None = None
    ended: datetime | None = None
    how: str = "killed"
    because: str = _KILLED


@dataclass(frozen=True)
class Gap:
    """A time in which nobody watched, or of which nothing is recorded.

    Attributes
    ----------
    began, ended : datetime
        UTC; of a gap that nobody knows the end of they are the same.
    began_h : float
        Hours since the record began.
    seconds : float
    because, mend : str
    over : bool
    first, steps : int
        Number of the first step that is not recorded, and how many.
    """

    began: datetime
    ended: datetime
    began_h: float
    seconds: float
    because: str
    mend: str
    over: bool = True
    first: int = 0
    steps: int = 0


class Continuity:
    """Follows a record, line by line.

    Attributes
    ----------
    runs : list of RunSpan
    unwatched : list of Gap
        Times in which nobody watched.
    unrecorded : list of Gap
        Steps that were done, but are not in the record.
    watched_s : float
        How long somebody watched.
    hours : float
        Since the record began, up to the last line that was taken, gaps included.
    """

    def __init__(self) -> None:
        self.runs: list[RunSpan] = []
        self.unwatched: list[Gap] = []
        self.unrecorded: list[Gap] = []
        self.watched_s = 0.0
        self._gaps_s = 0.0
        self._step: Mapping[str, Any] | None = None
        self._before: RunSpan | None = None

    @property
    def hours(self) -> float:
        return (self.watched_s + self._gaps_s) / 3600

    @property
    def unwatched_s(self) -> float:
        """How long nobody watched, as far as that is known."""
        return self._gaps_s

    def take(self, line: Mapping[str, Any]) -> None:
        """A header, a step, or a closing line, in the record's order."""
        if line["kind"] == "step":
            self._next_step(line)
        elif line["kind"] == "end":
            self._closing(line)
        elif not self.runs or line["run"] != self.runs[-1].header["run"]:
            closes = line.get("closes", False)  # older records do not
            how, because = ("killed", _KILLED) if closes else ("unknown", _UNKNOWN)
            self.runs.append(RunSpan(dict(line), _moment(line["run"]), how=how, because=because))

    def end(self, running: bool, whole: bool) -> None:
        """The record is over.

        Parameters
        ----------
        running : bool
            Whether its last run is still there.
        whole : bool
            Whether all of its files were read.
        """
        run = self.runs[-1] if self.runs else None
        if run is None or run.how != "killed":
            return
        if running:
            run.how, run.because = "running", _RUNNING
        elif not whole:
            run.how, run.because = "unknown", _ELSEWHERE
        else:
            last = run.last or run.began
            self._gap(last, last, 0.0, self._told(run), _MEND_KILLED, over=False)

    def _closing(self, line: Mapping[str, Any]) -> None:
        run = self.runs[-1]
        run.ended, run.how, run.because = _moment(line["written"]), line["how"], line["because"]
        last = 0 if self._step is None or self._before is not run else self._step["step"]
        if line["steps"] > last:
            since = run.last or run.began
            self._not_recorded(since, run.ended, last + 1, line["steps"] - last)
            self.watched_s += max(0.0, (run.ended - since).total_seconds())
            run.last = run.ended

    def _next_step(self, step: Mapping[str, Any]) -> None:
        run, now = self.runs[-1], _moment(step["written"])
        step_s = float(run.header["step_s"])
        if self._step is not None and self._before is run:
            self._within(run, self._step, step, step_s)
        else:
            self._first(run, now, step, step_s)
        run.steps, run.last = run.steps + 1, now
        self._step, self._before = step, run

    def _first(self, run: RunSpan, now: datetime, step: Mapping[str, Any], step_s: float) -> None:
        """The first step of a run: since when it watched, and whether somebody did before."""
        since = max(run.began, now - timedelta(seconds=step_s))
        if step["step"] > 1:
            since = run.began
            if run.header.get("part", 0) == 0:  # else its first files are gone, as they were too old
                self._not_recorded(run.began, now, 1, step["step"] - 1)
        before = self._before
        if before is not None and before.last is not None:
            away_s = (since - before.last).total_seconds()
            if away_s > _FEW_STEPS * step_s:
                mend = _MEND_STOPPED if before.how in ("steps", "until", "stopped") else _MEND_KILLED
                self._gap(before.last, since, away_s, self._told(before), mend)
        self.watched_s += float(step["time_s"]) if run.header.get("virtual") else (now - since).total_seconds()

    def _within(self, run: RunSpan, before: Mapping[str, Any], step: Mapping[str, Any], step_s: float) -> None:
        """Between two steps of a run."""
        began, now = _moment(before["written"]), _moment(step["written"])
        own_s = float(step["time_s"]) - float(before["time_s"])
        passed_s = own_s if run.header.get("virtual") else (now - began).total_seconds()
        jump = step["step"] - before["step"]
        if jump > 1:
            self._not_recorded(began, now, before["step"] + 1, jump - 1)
        due_s = jump * step_s
        if passed_s > due_s + _FEW_STEPS * step_s and passed_s > _TWICE * due_s:
            stood = own_s > due_s + _FEW_STEPS * step_s
            because, mend = (_STOOD_STILL, _MEND_STOOD_STILL) if stood else (_SLEPT, _MEND_SLEPT)
            self._gap(began, now, passed_s - due_s, because, mend)
            passed_s = due_s
        self.watched_s += passed_s if passed_s >= 0 else own_s  # the clock was set back

    def _not_recorded(self, began: datetime, ended: datetime, first: int, steps: int) -> None:
        seconds = max(0.0, (ended - began).total_seconds())
        because = f"{steps:,} step{'s were' if steps > 1 else ' was'} not recorded"
        mend = "has the folder of the record room, and may it be written to? keep_days says how long records are kept"
        self.unrecorded.append(Gap(began, ended, self.hours, seconds, because, mend, first=first, steps=steps))

    def _gap(
        self, began: datetime, ended: datetime, seconds: float, because: str, mend: str, over: bool = True
    ) -> None:
        self.unwatched.append(Gap(began, ended, self.hours, seconds, because, mend, over))
        self._gaps_s += seconds

    def _told(self, run: RunSpan) -> str:
        """How a run ended, and which one it was."""
        return f"run {self.runs.index(run) + 1}: {run.because}"


def _moment(written: str) -> datetime:
    return datetime.fromisoformat(written)
