"""The emulator's own truth: targets that move by the site's motion model while its clock runs."""

from __future__ import annotations

import math
import threading

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.world.truth import Truth

__all__ = ["MovingTargets"]

_ROUNDING = 1e-9


class MovingTargets:
    """Steps a truth as time passes.

    Parameters
    ----------
    truth : Truth
        At the moment when this is made.
    step_s : float
        Length of a step.
    directions : int
        How many direction bins the truth has.
    clock : Clock
    smooth : bool
        Between two steps targets go straight from one place to the next; otherwise they stand, and jump.
    """

    def __init__(self, truth: Truth, step_s: float, directions: int, clock: Clock, smooth: bool = True) -> None:
        self._step_s, self._directions, self._clock, self._smooth = step_s, directions, clock, smooth
        self._began_s = clock.now()
        self._steps, self._present, self._next = 0, truth, truth.step()
        self._lock = threading.Lock()

    @property
    def truth(self) -> Truth:
        """The truth of the last step that is over."""
        with self._lock:
            self._catch_up()
            return self._present

    def poses(self) -> tuple[Float[np.ndarray, "targets 2"], Float[np.ndarray, " targets"]]:
        """Where the targets are now, x and y in metres, and their headings in radians counter-clockwise from +x.

        nan for those that are outside. Who leaves by a door stands in it until the step is over; who comes in is there
        from the end of the step on.
        """
        with self._lock:
            share = self._catch_up()
            here, there = self._present, self._next
            if not self._smooth:
                return here.positions_m, self._headings(here)
            ahead = np.where(np.isnan(there.positions_m), here.positions_m, there.positions_m)
            return here.positions_m + share * (ahead - here.positions_m), self._headings(there)

    def _catch_up(self) -> float:
        """Step up to now; the share of the present step that is over."""
        steps = (self._clock.now() - self._began_s) / self._step_s
        while self._steps + 1 <= steps + _ROUNDING:
            self._steps, self._present, self._next = self._steps + 1, self._next, self._next.step()
        return min(max(steps - self._steps, 0.0), 1.0)

    def _headings(self, truth: Truth) -> Float[np.ndarray, " targets"]:
        return truth.directions * (2 * math.pi / self._directions)
