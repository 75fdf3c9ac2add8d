"""Where an emulated camera really looks, and what it tells of it: slew, clamping, reboots, and faults of both."""

from __future__ import annotations

import math
import threading
from collections.abc import Mapping

from surveillance_domain.cameras.base import Limits
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.emulation.faults import Faults
from surveillance_domain.emulation.kinematics import Axes, Journey

__all__ = ["EmulatedMotors"]

_AXES = ("pan", "tilt", "zoom")


class EmulatedMotors:
    """Pan, tilt and zoom.

    Parameters
    ----------
    start : (pan, tilt, zoom)
        Where it looks at first.
    limits : Limits
        A position beyond them is clamped without a word.
    speeds : (float, float, float)
        Degrees, degrees and zoom positions a second; infinity: at once.
    clock : Clock
    boot_s : float
        How long a reboot takes.
    """

    def __init__(self, start: Axes, limits: Limits, speeds: Axes, clock: Clock, boot_s: float = 45.0) -> None:
        self.faults = Faults()
        self.limits = limits
        self._clock, self._boot_s = clock, boot_s
        self._journey = Journey(start, start, clock.now(), speeds)
        self._reboot_at: float | None = None
        self._awake_at = -math.inf
        self._forgets = False
        self._frozen: Axes | None = None
        self._drift_deg, self._drift_seen_s = 0.0, clock.now()
        self._lock = threading.RLock()

    @property
    def deg_per_s(self) -> float:
        """The slower of pan and tilt; 100 where they take no time."""
        slower = min(self._journey.speeds[:2])
        return slower if math.isfinite(slower) else 100.0

    def command(self, query: Mapping[str, str]) -> None:
        """Go where ``pan``, ``tilt``, ``zoom`` say, or by how much ``rpan``, ``rtilt``, ``rzoom`` say, or home.

        Raises
        ------
        ValueError
            For anything that is not a finite number, as the camera words it.
        """
        with self._lock:
            now = self._now()
            here = self._journey.at(now)
            goal = list((0.0, 0.0, 1.0) if query.get("move") == "home" else self._journey.goal)
            for number, axis in enumerate(_AXES):
                if axis in query:
                    goal[number] = _number(axis, query[axis])
                if f"r{axis}" in query:
                    goal[number] = here[number] + _number(f"r{axis}", query[f"r{axis}"])
            self._journey = self._journey.onward(self._clamped(goal), now)
            if self.faults.reboot_in_move:
                self.faults.reboot_in_move = False
                self._reboot_at = (now + self._journey.ends_s) / 2

    def reboot(self) -> None:
        """Reboot now."""
        with self._lock:
            self._reboot_at = self._clock.now()
            self._now()

    def awake(self) -> bool:
        """Whether it is not rebooting."""
        with self._lock:
            return self._now() >= self._awake_at

    def rebooted(self) -> bool:
        """Whether it has rebooted since this was last asked."""
        with self._lock:
            forgets, self._forgets = self._forgets, False
            return forgets

    def true(self) -> Axes:
        """Where it really looks now."""
        with self._lock:
            pan, tilt, zoom = self._journey.at(self._now())
            return pan + self.faults.pan_slip_deg, tilt, zoom

    def told(self) -> Axes:
        """Where it says it looks now."""
        with self._lock:
            now = self._now()
            pan, tilt, zoom = self._journey.at(now)
            if not self.faults.frozen:
                self._frozen = None
            elif self._frozen is None:
                self._frozen = (pan, tilt, zoom)
            return self._frozen or (pan + self._drift_deg, tilt, zoom)

    def _now(self) -> float:
        """The time; whatever has happened by itself up to it, has happened."""
        now = self._clock.now()
        self._drift_deg += self.faults.pan_drift_deg_per_s * (now - self._drift_seen_s)
        self._drift_seen_s = now
        if self._reboot_at is not None and now >= self._reboot_at:
            self._awake_at = self._reboot_at + self._boot_s
            self._reboot_at = None
            home = self._clamped([0.0, 0.0, 1.0])
            self._journey = Journey(home, home, now, self._journey.speeds)
            self._forgets, self._drift_deg, self._frozen = True, 0.0, None
        return now

    def _clamped(self, goal: list[float]) -> Axes:
        ends = (self.limits.pan, self.limits.tilt, self.limits.zoom)
        pan, tilt, zoom = (g if e is None else min(max(g, e[0]), e[1]) for g, e in zip(goal, ends, strict=True))
        return pan, tilt, zoom


def _number(key: str, text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise ValueError(f"{key}: invalid value: {text}")
    return value
