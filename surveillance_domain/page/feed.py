"""What every browser is shown: the last snapshot, the last picture of each camera, and the course of the last steps."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from surveillance_domain.page.snapshot import PictureSnapshot, Snapshot

__all__ = ["COURSE_STEPS", "Feed", "Latest", "Point"]

COURSE_STEPS = 600
"""Steps that the curves show."""


@dataclass(frozen=True)
class Point:
    """What the curves show of one step."""

    number: int
    percent_obs: float | None
    expected: float | None
    seen: int


@dataclass(frozen=True, eq=False)
class Latest:
    """The state of the watch at one moment.

    Attributes
    ----------
    snapshot : Snapshot
    pictures : dict of str to PictureSnapshot
        Of each camera the last one there is.
    course : tuple of Point
        Of the last steps, in order.
    age_s : float
        How long ago the step came.
    """

    snapshot: Snapshot
    pictures: Mapping[str, PictureSnapshot]
    course: tuple[Point, ...]
    age_s: float


class Feed:
    """Written by the thread of the watch, read by that of the page; what it keeps does not grow with the steps."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._snapshot: Snapshot | None = None
        self._pictures: dict[str, PictureSnapshot] = {}
        self._course: deque[Point] = deque(maxlen=COURSE_STEPS)
        self._came_s = 0.0

    def put(self, snapshot: Snapshot) -> None:
        """A step is over."""
        with self._lock:
            self._snapshot, self._came_s = snapshot, time.monotonic()
            self._pictures |= {one.name: one.picture for one in snapshot.cameras if one.picture is not None}
            self._course.append(Point(snapshot.number, snapshot.percent_obs, snapshot.expected, snapshot.seen))

    def latest(self) -> Latest | None:
        """How things stand; ``None`` before the first step."""
        with self._lock:
            if self._snapshot is None:
                return None
            age = time.monotonic() - self._came_s
            return Latest(self._snapshot, dict(self._pictures), tuple(self._course), age)
