"""Trying again after a passing failure, with growing pauses of random length, as long as there is time."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TypeVar

import numpy as np

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraAway, Unreachable

__all__ = ["pauses_s", "with_retries"]

T = TypeVar("T")


def pauses_s(rng: np.random.Generator, retries: int = 3, first_s: float = 0.1) -> Iterator[float]:
    """How long to wait before each retry: about 0.1, 0.2 and 0.4 seconds, each between half and one and a half of it.

    The jitter keeps many cameras behind one failing switch from asking in step.
    """
    for retry in range(retries):
        yield first_s * 2**retry * float(rng.uniform(0.5, 1.5))


def with_retries(attempt: Callable[[], T], clock: Clock, rng: np.random.Generator, until: float) -> T:
    """What an attempt gives, tried anew after `Unreachable` while a pause still ends before the deadline.

    Raises
    ------
    Unreachable
        The last one.
    CameraError
        Any other, at once: a refusal stays a refusal.
    """
    for pause_s in pauses_s(rng):
        try:
            return attempt()
        except CameraAway:
            raise
        except Unreachable:
            if clock.now() + pause_s >= until:
                raise
        clock.sleep(pause_s)
    return attempt()
