"""Where a camera can be that goes from one position to another.

Each axis goes straight to its goal, all beginning at once, as fast as it can or so that all arrive together. So the
axis that has the shorter time to go is never behind the other in the share of its way, nor ahead of it in time; a data
sheet's speeds are trusted only roughly, and axes may set off a little apart.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import permutations

from surveillance_domain.cameras.base import ZOOM_TOLERANCE, Position

__all__ = ["Speeds", "along", "least_time_s", "places_on_the_way"]

Speeds = tuple[float | None, float | None, float | None]
"""Of pan and tilt in degrees and of zoom in positions a second; ``None``: not known."""

_HALF_TURN_DEG = 180.0
_OFF_SPEED = 1.5
"""By how much the ratio of two axes' speeds may be off."""
_APART_S = 0.1
"""How long after each other axes may set off."""
_PLACES = 9


def along(start: Position, goal: Position, position: Position, speeds: Speeds, tolerance_deg: float) -> bool:
    """Whether a position can be met on the way.

    Parameters
    ----------
    start, goal, position : Position
    speeds : (float or None, float or None, float or None)
    tolerance_deg : float
        How far beside the way, before its start or behind its goal pan and tilt may be.
    """
    timed: list[tuple[float, float]] = []
    axes = _axes(start, goal, position, tolerance_deg)
    for (begin, end, value, tolerance), speed in zip(axes, speeds, strict=False):
        length = abs(end - begin)
        gone = value - begin if end >= begin else begin - value
        if not -tolerance <= gone <= length + tolerance:
            return False
        if speed is not None and length > tolerance:
            timed.append((length / speed, min(max(gone, 0.0), length) / speed))
    return all(_in_step(short, long) for short, long in permutations(timed, 2) if short[0] <= long[0])


def places_on_the_way(start: Position, goal: Position, speeds: Speeds, within_s: float) -> Iterator[Position]:
    """Some positions in equal distances that a camera may have come to in a time, the start among them."""
    longest_s = least_time_s(start, goal, speeds) or 0.0
    most = min(1.0, within_s / longest_s) if longest_s > 0 else 1.0
    for number in range(_PLACES):
        share = most * number / (_PLACES - 1)
        zoom = None if start.zoom is None or goal.zoom is None else start.zoom + share * (goal.zoom - start.zoom)
        yield Position(start.pan + share * (goal.pan - start.pan), start.tilt + share * (goal.tilt - start.tilt), zoom)


def least_time_s(start: Position, goal: Position, speeds: Speeds) -> float | None:
    """How long the way takes at least; ``None`` where no speed is known."""
    times = [
        abs(end - begin) / speed
        for (begin, end, _, _), speed in zip(_axes(start, goal, start, 0.0), speeds, strict=False)
        if speed is not None
    ]
    return max(times, default=None)


def _axes(
    start: Position, goal: Position, position: Position, tolerance_deg: float
) -> list[tuple[float, float, float, float]]:
    """Start, goal, value and tolerance of each axis that tells something.

    A camera without end stops may pan the other way round where that is shorter, so a long pan tells nothing.
    """
    pan = (start.pan, goal.pan, position.pan, tolerance_deg)
    if abs(goal.pan - start.pan) > _HALF_TURN_DEG:
        pan = (0.0, 0.0, 0.0, tolerance_deg)
    found = [pan, (start.tilt, goal.tilt, position.tilt, tolerance_deg)]
    if start.zoom is not None and goal.zoom is not None and position.zoom is not None:
        found.append((start.zoom, goal.zoom, position.zoom, ZOOM_TOLERANCE))
    return found


def _in_step(short: tuple[float, float], long: tuple[float, float]) -> bool:
    """Whether two axes fit, each given by the time that its way takes and by the time that it has been gone for."""
    ahead = short[1] <= _OFF_SPEED * long[1] + _APART_S
    behind = short[1] >= short[0] / long[0] * long[1] / _OFF_SPEED - _APART_S
    return ahead and behind
