"""People come first: a camera that somebody else moves, or holds, gets no commands."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from surveillance_domain.cameras.base import Position

__all__ = ["HELD", "MOVED", "Yielding", "taken"]

HELD = "held"
MOVED = "moved by somebody else"
"""Why a camera gets no commands."""

_HALF_TURN_DEG = 180.0


@dataclass(frozen=True)
class _Way:
    """Where a camera can be that was sent from one position to another, the same for one that was left standing."""

    start: Position
    goal: Position

    def holds(self, position: Position, tolerance_deg: float) -> bool:
        if any(position.agrees(end, tolerance_deg) for end in (self.start, self.goal)):
            return True
        if self.start == self.goal:
            return False
        if abs(self.goal.pan - self.start.pan) > _HALF_TURN_DEG:
            return True  # a camera without end stops may go round the other way
        return all(
            min(start, goal) - tolerance_deg <= value <= max(start, goal) + tolerance_deg
            for value, start, goal in (
                (position.pan, self.start.pan, self.goal.pan),
                (position.tilt, self.start.tilt, self.goal.tilt),
            )
        )


class Yielding:
    """Watches one camera for moves that nobody here asked for.

    Parameters
    ----------
    tolerance_deg : float
        How far a camera may be from where it was left, and still count as there.
    yield_s : float
        How long it must be still, once it moved by itself, before it is commanded again.
    """

    def __init__(self, tolerance_deg: float, yield_s: float) -> None:
        self._tolerance_deg, self._yield_s = tolerance_deg, yield_s
        self._way: _Way | None = None
        self._still_since: float | None = None
        self._last: Position | None = None

    @property
    def yields(self) -> bool:
        """Whether somebody else has it."""
        return self._still_since is not None

    def left_at(self, position: Position | None) -> None:
        """It reached where it was sent; ``None``: it failed or is held, and may be anywhere."""
        self._way = None if position is None else _Way(position, position)

    def sent_to(self, goal: Position) -> None:
        """It was sent somewhere and has not arrived: it is on its way from where it was found last, or back there."""
        self._way = None if self._last is None else _Way(self._last, goal)

    def found_at(self, position: Position, now_s: float) -> None:
        """Where it was found to look."""
        if self._still_since is not None:
            if self._last is None or not position.agrees(self._last, self._tolerance_deg):
                self._still_since = now_s
            elif now_s - self._still_since >= self._yield_s:
                self._still_since = None
        elif self._way is not None and not self._way.holds(position, self._tolerance_deg):
            self._still_since, self._way = now_s, None
        self._last = position


def taken(watched: Mapping[str, Yielding], held: Collection[str]) -> dict[str, str]:
    """Cameras that get no commands, and why: `HELD` or `MOVED`."""
    return {name: HELD if name in held else MOVED for name, one in watched.items() if name in held or one.yields}
