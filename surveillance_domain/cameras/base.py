"""A camera as the control loop meets it, whatever its driver."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Protocol, runtime_checkable

if TYPE_CHECKING:
    from surveillance_domain.cameras.witness import Witness

__all__ = ["Camera", "Health", "HealthState", "Limits", "Move", "Outcome", "Picture", "Position", "ZOOM_TOLERANCE"]

ZOOM_TOLERANCE = 20.0
"""Zoom positions (of 1 to 9999) within which two are the same."""


@dataclass(frozen=True)
class Position:
    """Where a camera looks, in its own numbers.

    Attributes
    ----------
    pan, tilt : float
        Degrees.
    zoom : float or None
        Zoom position; ``None`` where the camera does not tell it.
    """

    pan: float
    tilt: float
    zoom: float | None = None

    def agrees(self, other: Position, tolerance_deg: float) -> bool:
        """Whether another position is the same within a tolerance; pan goes round, so -180 is 180."""
        if max(abs(_turn(self.pan - other.pan)), abs(self.tilt - other.tilt)) > tolerance_deg:
            return False
        return self.zoom is None or other.zoom is None or abs(self.zoom - other.zoom) <= ZOOM_TOLERANCE


def _turn(angle_deg: float) -> float:
    """The same angle between -180 and 180 degrees."""
    return (angle_deg + 180.0) % 360.0 - 180.0


@dataclass(frozen=True)
class Limits:
    """How far a camera turns; ``None`` where it does not say.

    Attributes
    ----------
    pan, tilt : (float, float) or None
        Least and greatest, in degrees.
    zoom : (float, float) or None
        Least and greatest zoom position.
    """

    pan: tuple[float, float] | None = None
    tilt: tuple[float, float] | None = None
    zoom: tuple[float, float] | None = None

    def faults(self, position: Position) -> tuple[str, ...]:
        """What about a position lies outside, such as ``pan -175 is outside -170 to 170``."""
        found = []
        for axis in ("pan", "tilt", "zoom"):
            value, limits = getattr(position, axis), getattr(self, axis)
            if value is not None and limits is not None and not limits[0] <= value <= limits[1]:
                found.append(f"{axis} {value:g} is outside {limits[0]:g} to {limits[1]:g}")
        return tuple(found)


class Outcome(StrEnum):
    """What became of a move."""

    REACHED = "reached"
    STALLED = "stalled"
    TIMED_OUT = "timed out"
    UNREACHABLE = "unreachable"


@dataclass(frozen=True)
class Move:
    """A move that is over.

    Attributes
    ----------
    outcome : Outcome
        ``REACHED``: the position read back is within tolerance and was stable for the settle time.
    position : Position or None
        The last one read back; ``None`` if none was.
    seconds : float
        How long it took.
    because : str
        Why it did not reach, without the camera's name; empty if it did.
    fault : str
        The class of the error that kept it from reaching; empty if it did, or if somebody else has the camera.
    commanded : bool
        ``False``: nothing was sent, for somebody else has the camera.
    """

    outcome: Outcome
    position: Position | None
    seconds: float
    because: str = ""
    fault: str = ""
    commanded: bool = True


@dataclass(frozen=True)
class Picture:
    """A whole JPEG, taken while the camera stood still.

    Attributes
    ----------
    jpeg : bytes
    width, height : int
        Pixels.
    position : Position
        Read back just after it, and the same just before.
    time_s : float
        On the camera's clock, just after it.
    """

    jpeg: bytes
    width: int
    height: int
    position: Position
    time_s: float


class HealthState(StrEnum):
    """Whether a camera takes part."""

    READY = "ready"
    AWAY = "away"
    LOCKED_OUT = "locked out"


@dataclass(frozen=True)
class Health:
    """How a camera is.

    Attributes
    ----------
    state : HealthState
        ``AWAY``: it failed three times in a row and is left alone for a while; ``LOCKED_OUT``: it refused the log-in.
    failures : int
        Failed exchanges since the driver was made.
    returns_s : float or None
        When, on its clock, it will be tried again; ``None`` while it is ready.
    because : str
        The last failure, without the camera's name; empty if there was none.
    """

    state: HealthState
    failures: int
    returns_s: float | None = None
    because: str = ""


@runtime_checkable
class Camera(Protocol):
    """A pan/tilt/zoom camera. One thread at a time speaks with it; others wait.

    Every method but `health` and `close` raises `surveillance_domain.cameras.errors.CameraError`, and nothing else,
    when it cannot do what it says; `move` tells it in its outcome instead.
    """

    @property
    def name(self) -> str:
        """The camera's name at its site."""

    @property
    def health(self) -> Health:
        """How it is, without asking it."""

    def watched_by(self, witness: Witness) -> None:
        """From now on tell a witness of every position and every move; once it yields, no move is sent."""

    def start(self, budget_s: float) -> Limits:
        """Get to know the camera and refuse presets that it cannot reach, all of them by name."""

    def position(self, budget_s: float) -> Position:
        """Where it looks now."""

    def move(self, target: Position, budget_s: float) -> Move:
        """Turn to a position and wait until it is there and still, no longer than the budget.

        While the witness yields it is not turned, nor turned further: `Outcome.STALLED`, because of `witness.MOVED`.
        """

    def picture(self, budget_s: float) -> Picture:
        """What it sees now."""

    def close(self) -> None:
        """Let go of its connection."""
