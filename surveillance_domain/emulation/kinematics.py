"""Motors: every axis on its own, at a constant speed, straight to where it was sent."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["Axes", "Journey"]

Axes = tuple[float, float, float]
"""Pan and tilt in degrees, zoom position; or the speed of each."""


@dataclass(frozen=True)
class Journey:
    """A move from one place to another.

    Attributes
    ----------
    start, goal : (pan, tilt, zoom)
    began_s : float
        On the emulator's clock.
    speeds : (float, float, float)
        Degrees, degrees and zoom positions a second; infinity: no time passes.
    """

    start: Axes
    goal: Axes
    began_s: float
    speeds: Axes

    @property
    def ends_s(self) -> float:
        """When the slowest axis is there."""
        return self.began_s + max(abs(b - a) / v for a, b, v in zip(self.start, self.goal, self.speeds, strict=True))

    def at(self, now: float) -> Axes:
        """Where the axes are."""
        passed = max(now - self.began_s, 0.0)
        pan, tilt, zoom = (
            _towards(a, b, v * passed if math.isfinite(v) else math.inf)
            for a, b, v in zip(self.start, self.goal, self.speeds, strict=True)
        )
        return pan, tilt, zoom

    def onward(self, goal: Axes, now: float) -> Journey:
        """A new move, from where the axes are now."""
        return Journey(self.at(now), goal, now, self.speeds)


def _towards(start: float, goal: float, way: float) -> float:
    return goal if way >= abs(goal - start) else start + math.copysign(way, goal - start)
