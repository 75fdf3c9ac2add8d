"""People come first: a camera that somebody else moves, or holds, gets no commands.

Every position that the camera tells and every move that is asked of it is followed. A position is ours if the camera
stands where it stood, or can be on the way to somewhere it was sent; any other is evidence of somebody else. Failures
take nothing from that: a command of which nobody knows whether it came through may take effect for half a minute more.
Only after a silence in which the camera may have rebooted nothing is expected of it until it stands still again. Who
was moved is remembered for the one who commands the camera next.
"""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass

from surveillance_domain.cameras.base import Position
from surveillance_domain.cameras.witness import MOVED, Witness
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.world.memory import Memory, Stood, still_for_s
from surveillance_domain.world.way import Speeds, along, least_time_s, places_on_the_way

__all__ = ["HELD", "MOVED", "Yielding", "taken", "watching"]

HELD = "held"
"""Why a camera gets no commands; the other reason is `MOVED`."""

_BOOT_S = 10.0
"""No camera is back from a reboot in less."""
_LATE_S = 30.0
"""For so long a command whose answer was lost may still take effect."""
_LAG_S = 0.3
"""A position told may be that much older than the question."""
_RENEWED_S = 60.0
"""Where it stands is taken anew that often: read-backs drift by degrees in hours."""
_LEAST_PACE_S = 0.5
"""Over which a camera's pace is measured, at least."""
_CRAWL = 0.1
"""A camera that goes slower than with this share of its speed does not go by itself."""
_MOST_GOALS = 8
_BESIDE = 2.0
"""Tolerances by which a camera that turns may be beside its way."""


@dataclass
class _Asked:
    goal: Position
    at_s: float
    accepted: bool = False


class Yielding(Witness):
    """Watches one camera for moves that nobody here asked for.

    Parameters
    ----------
    tolerance_deg : float
        How far a camera may be from where it stood, and still count as there.
    yield_s : float
        How long it must be still, once it moved by itself, before it is commanded again.
    speeds : (float or None, float or None, float or None)
        Of pan, tilt and zoom, as far as they are known.
    settle_s : float
        How long it takes to come to rest.
    memory : Memory, optional
        Of the camera, from before, and for later.
    """

    def __init__(
        self,
        tolerance_deg: float,
        yield_s: float,
        speeds: Speeds = (None, None, None),
        settle_s: float = 0.0,
        memory: Memory | None = None,
    ) -> None:
        self._tolerance_deg, self._yield_s, self._speeds = tolerance_deg, yield_s, speeds
        self._memory = memory or Memory()
        self._remembered = still_for_s(self._memory, yield_s, tolerance_deg, None) is not None
        self._pace_s = max(_LEAST_PACE_S, 2 * settle_s)
        self._lock = threading.Lock()
        self._place: Position | None = None
        self._since, self._under_way = 0.0, False
        self._mark: tuple[Position, float] | None = None
        self._asked: list[_Asked] = []
        self._last: Position | None = None
        self._last_s = 0.0
        self._failed, self._rebooted = False, False
        self._still_since: float | None = None

    @property
    def yields(self) -> bool:
        """Whether somebody else has it."""
        return self._remembered or self._still_since is not None

    def let_go(self) -> None:
        """It is held by people: until it is commanded again, nothing is expected of it."""
        with self._lock:
            self._place, self._asked = None, []

    def sent(self, goal: Position, now_s: float) -> None:
        with self._lock:
            if self._place is None and not self._rebooted and self._last is not None:
                self._stands(self._last, now_s)
            self._mark = None
            kept = [one for one in self._asked if not one.goal.agrees(goal, self._tolerance_deg)]
            self._asked = [*kept[1 - _MOST_GOALS :], _Asked(goal, now_s)]

    def accepted(self, goal: Position) -> None:
        with self._lock:
            for one in self._asked:
                one.accepted = one.accepted or one.goal == goal
            if self._last is not None and self._last.agrees(goal, self._tolerance_deg):
                self._arrived(self._last, self._last_s)

    def failed(self) -> None:
        self._failed = True

    def read(self, position: Position, asked_s: float, now_s: float) -> None:
        with self._lock:
            if self._failed and now_s - self._last_s >= _BOOT_S:
                self._place, self._asked, self._rebooted = None, [], True
            self._failed = False
            if self._remembered:
                self._look_again(position, now_s)
            elif self._still_since is not None:
                self._wait(position, self._still_since, now_s)
            elif not self._ours(position, asked_s, now_s):
                self._place, self._asked = None, []
                self._moved(position, now_s)
            self._last, self._last_s = position, now_s

    def _look_again(self, position: Position, now_s: float) -> None:
        """Somebody had it before anybody here looked; whether it still stands there."""
        still_s = still_for_s(self._memory, self._yield_s, self._tolerance_deg, position)
        self._still_since, self._remembered = None if still_s is None else now_s - still_s, False

    def _wait(self, position: Position, still_since: float, now_s: float) -> None:
        """Somebody has it; once it has been still for long enough, nobody has."""
        if self._last is None or not position.agrees(self._last, self._tolerance_deg):
            self._moved(position, now_s)
        elif now_s - still_since >= self._yield_s:
            self._still_since = None
            self._memory.keep(None)
            self._stands(position, now_s)

    def _moved(self, position: Position, now_s: float) -> None:
        self._still_since = now_s
        self._memory.keep(Stood(position, 0.0))

    def _ours(self, position: Position, asked_s: float, now_s: float) -> bool:
        """Whether a position is explained by what was asked; where it stands is taken from it then."""
        self._asked = [one for one in self._asked if one.accepted or now_s - one.at_s <= _LATE_S]
        if self._place is None:
            if self._asked and not self._arrived(position, now_s):
                self._settles(position, now_s)
            return True
        if self._arrived(position, now_s):
            return True
        if self._crawls(position, asked_s, now_s):
            return False
        if position.agrees(self._place, self._tolerance_deg):
            if not self._under_way and now_s - self._since >= _RENEWED_S:
                self._stands(position, now_s)
            return True
        for number in self._goals_in_reach(position, now_s):
            self._stands(position, now_s, under_way=True)
            self._mark = self._mark or (position, now_s)
            self._asked = [one for n, one in enumerate(self._asked) if n >= number or not one.accepted]
            return True
        return False

    def _arrived(self, position: Position, now_s: float) -> bool:
        """Whether it is where it was sent; what was asked before that is done then."""
        for number, one in reversed(list(enumerate(self._asked))):
            if position.agrees(one.goal, self._tolerance_deg):
                if self._under_way or self._place is None or not self._place.agrees(one.goal, self._tolerance_deg):
                    self._stands(one.goal, now_s)
                self._asked = [
                    other for n, other in enumerate(self._asked) if n != number and (n > number or not other.accepted)
                ]
                return True
        return False

    def _settles(self, position: Position, now_s: float) -> None:
        """Nothing is known of where it should be: it is believed where it stands."""
        if self._last is not None and position.agrees(self._last, self._tolerance_deg):
            self._stands(position, now_s)

    def _stands(self, position: Position, now_s: float, under_way: bool = False) -> None:
        self._place, self._since, self._under_way, self._rebooted = position, now_s, under_way, False

    def _crawls(self, position: Position, asked_s: float, now_s: float) -> bool:
        """Whether it set off by our command and then goes on far too slowly, or stands still before its goal."""
        if not self._under_way or not all(one.accepted for one in self._asked):
            self._mark = None
        if self._mark is None:
            return False
        marked, marked_s = self._mark
        passed_s = asked_s - marked_s
        if passed_s < self._pace_s:
            return False
        self._mark = (position, now_s)
        gone_s = least_time_s(marked, position, self._speeds)
        return position.agrees(marked, self._tolerance_deg) or (gone_s is not None and gone_s < _CRAWL * passed_s)

    def _goals_in_reach(self, position: Position, now_s: float) -> Iterator[int]:
        """The numbers of the goals on the way to which it can be.

        It may set out from where it stood, from a goal that its read-back did not show, or, sent elsewhere while it was
        under way, from a place on that way.
        """
        goals = [one.goal for one in self._asked]
        beside = _BESIDE * self._tolerance_deg
        starts = [self._place, *goals] if self._place is not None else goals
        for number, goal in enumerate(goals):
            if any(along(start, goal, position, self._speeds, beside) for start in starts[: number + 1]):
                yield number
        within_s = now_s - self._last_s + _LAG_S
        for first, earlier in enumerate(goals):
            for number in range(first + 1, len(goals)):
                for turn in places_on_the_way(starts[0], earlier, self._speeds, within_s):
                    if along(turn, goals[number], position, self._speeds, beside):
                        yield number


def watching(camera: CameraDescription, yield_s: float, memory: Memory | None = None) -> Yielding:
    """Who watches a camera, by what the site says of it."""
    speeds = (camera.pan_deg_per_s, camera.tilt_deg_per_s, camera.zoom_per_s)
    return Yielding(camera.tolerance_deg, yield_s, speeds, camera.settle_s, memory)


def taken(watched: Mapping[str, Yielding], held: Collection[str]) -> dict[str, str]:
    """Cameras that get no commands, and why: `HELD` or `MOVED`."""
    return {name: HELD if name in held else MOVED for name, one in watched.items() if name in held or one.yields}
