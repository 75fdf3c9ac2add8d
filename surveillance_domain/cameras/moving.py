"""Turning a camera to a position: asked once, then watched until it is there and still, or is not going to be.

Only absolute moves are sent, so sending one twice does no harm. All the same, when it is not known whether one came
through, the position is read before it is sent again. Nothing is sent, or sent again, once a position read back shows
that somebody else moves the camera.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from surveillance_domain.cameras.base import Move, Outcome, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import (
    CameraAway,
    CameraError,
    NotThereInTime,
    StandsStill,
    TooSlow,
    Unreachable,
)
from surveillance_domain.cameras.retry import pauses_s
from surveillance_domain.cameras.steadiness import Steadiness
from surveillance_domain.cameras.witness import MOVED, Witness

__all__ = ["Motors", "Pace", "drive"]

_SHORTEST_POLL_S = 0.02
_POLL_S = 0.1
_LEAST_STALL_S = 1.0
_ROUNDING_S = 1e-6
_SET_OFF_S = 0.4
"""One that tells the same position so long after it was asked to move has not set off."""
_SLOW_SHARE = 0.5
"""Of the time for a move: an answer that takes longer leaves none to watch it."""


@runtime_checkable
class Motors(Protocol):
    """What a driver must be able to do."""

    steadiness: Steadiness
    witness: Witness

    def read(self, until: float) -> Position:
        """The position now, told to `steadiness` and `witness`; tried again if need be."""

    def send(self, target: Position, until: float) -> None:
        """Ask for a move, once, and tell `witness`."""


@dataclass(frozen=True)
class Pace:
    """When a move counts as over.

    Attributes
    ----------
    tolerance_deg : float
        How near is there.
    settle_s : float
        How long it must be still there.
    travel_s : callable
        How long a move between two positions takes at least, in seconds; zero where that is not known.
    """

    tolerance_deg: float
    settle_s: float
    travel_s: Callable[[Position, Position], float]

    @property
    def stall_s(self) -> float:
        """How long it may be still elsewhere, once asked to move."""
        return max(_LEAST_STALL_S, 2 * self.settle_s)


def drive(motors: Motors, target: Position, pace: Pace, clock: Clock, rng: np.random.Generator, until: float) -> Move:
    """Turn to a position and wait for the end; never raises for what a camera does.

    Parameters
    ----------
    until : float
        Deadline on the clock.
    """
    start = clock.now()
    trip = _Trip(motors, target, pace, clock, rng, until)
    try:
        outcome, because, fault = trip.go()
    except _Taken:
        return Move(Outcome.STALLED, trip.last, clock.now() - start, MOVED, commanded=trip.commanded)
    except CameraError as error:
        return Move(Outcome.UNREACHABLE, trip.last, clock.now() - start, str(error), type(error).__name__)
    if outcome is Outcome.TIMED_OUT and trip.slowest_s >= _SLOW_SHARE * (until - start):
        because, fault = TooSlow.because(trip.slowest_s, until - start), TooSlow
    return Move(outcome, trip.last, clock.now() - start, because, "" if fault is None else fault.__name__)


class _Taken(Exception):
    """Somebody else has the camera."""


class _Trip:
    """One move under way."""

    def __init__(
        self, motors: Motors, target: Position, pace: Pace, clock: Clock, rng: np.random.Generator, until: float
    ) -> None:
        self._motors, self._target, self._pace = motors, target, pace
        self._clock, self._rng, self._until = clock, rng, until
        self.last: Position | None = None
        self.slowest_s = 0.0
        self._asked = -math.inf
        self.commanded = False

    def go(self) -> tuple[Outcome, str, type[CameraError] | None]:
        """Send and watch; what became of it, why, and which error that is."""
        begun = here = self._read()
        if here.agrees(self._target, self._pace.tolerance_deg):
            self._motors.witness.sent(self._target, self._clock.now())
            self._motors.witness.accepted(self._target)
        else:
            self._send(here)
        sent = self._clock.now()
        while True:
            steady_s = self._motors.steadiness.still_s(self._clock.now())
            there = here.agrees(self._target, self._pace.tolerance_deg)
            if there and steady_s >= self._pace.settle_s - _ROUNDING_S:
                return Outcome.REACHED, "", None
            if not there and min(steady_s, self._clock.now() - sent) >= self._pace.stall_s:
                return Outcome.STALLED, f"it stands at {_shown(here)} instead of {_shown(self._target)}", StandsStill
            wait_s = self._pace.settle_s - steady_s if there else self._pace.travel_s(here, self._target) or _POLL_S
            self._clock.sleep(min(max(wait_s, _SHORTEST_POLL_S), self._until - self._clock.now()))
            if self._clock.now() >= self._until:
                return Outcome.TIMED_OUT, *self._unfinished(begun, here, self._asked - sent)
            here = self._read()

    def _unfinished(self, begun: Position, here: Position, after_s: float) -> tuple[str, type[CameraError]]:
        """What a move that is not over in time had come to, so long after it was sent."""
        if here.agrees(self._target, self._pace.tolerance_deg):
            return f"it was at {_shown(here)}, but not still for long enough", NotThereInTime
        if here.agrees(begun, self._pace.tolerance_deg) and after_s >= _SET_OFF_S - _ROUNDING_S:
            return f"it stood at {_shown(here)} and did not set off to {_shown(self._target)}", StandsStill
        return f"it was at {_shown(here)} on its way to {_shown(self._target)}", NotThereInTime

    def _read(self) -> Position:
        self._asked = self._clock.now()
        self.last = self._motors.read(self._until)
        self.slowest_s = max(self.slowest_s, self._clock.now() - self._asked)
        if self._motors.witness.yields:
            raise _Taken
        return self.last

    def _send(self, here: Position) -> None:
        """Ask for the move; after a failure only if the camera does not move for all that."""
        self.commanded = True
        for pause_s in pauses_s(self._rng):
            try:
                return self._motors.send(self._target, self._until)
            except CameraAway:
                raise
            except Unreachable:
                if self._clock.now() + pause_s >= self._until:
                    raise
            self._clock.sleep(pause_s)
            now_at = self._read()
            if not now_at.agrees(here, self._pace.tolerance_deg) or now_at.agrees(
                self._target, self._pace.tolerance_deg
            ):
                return None
        return self._motors.send(self._target, self._until)


def _shown(position: Position) -> str:
    zoom = "" if position.zoom is None else f", zoom {position.zoom:g}"
    return f"pan {position.pan:g}, tilt {position.tilt:g}{zoom}"
