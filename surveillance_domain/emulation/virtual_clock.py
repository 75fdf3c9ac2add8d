"""A clock that jumps: when everybody who is at work sleeps, it is at once the time at which the first one wakes.

It counts those at work. The thread that made the clock is one of them; `together` puts its tasks in the caller's
place, and the last of them gives it back, unless the caller's deadline came first. A thread that does something for
another that waits for it, such as a server for its client, is not counted: its sleep is the other's. When the count
falls to zero, the clock moves on to the earliest waking time and wakes all whose time it is, each of whom counts again
before anybody runs; so sleeps overlap as they would on a wall clock, and what the time is when someone wakes does not
depend on how quick the machine is.
"""

from __future__ import annotations

import heapq
import itertools
import math
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import AbstractContextManager, nullcontext
from typing import TypeVar

__all__ = ["StoppedClock", "VirtualClock"]

T = TypeVar("T")

_A_WAIT_S = 0.1


class StoppedClock(RuntimeError):
    """Somebody who counts as at work neither sleeps nor ends, so time does not pass for the others."""


def _waited(woken: threading.Event, patience_s: float) -> bool:
    """Whether it is woken in time; short waits are counted, of which a stop of the process uses up but one."""
    return any(woken.wait(_A_WAIT_S) for _ in range(math.ceil(patience_s / _A_WAIT_S)))


class VirtualClock:
    """Time that takes no time.

    Parameters
    ----------
    start_s : float
        The first `now`.
    patience_s : float
        Real seconds that a sleeper waits to be woken, before it gives up with `StoppedClock`; time in which the whole
        process is stopped does not count.
    """

    def __init__(self, start_s: float = 0.0, patience_s: float = 60.0) -> None:
        self._now, self._patience_s = start_s, patience_s
        self._lock = threading.Lock()
        self._at_work = 1
        self._sleepers: list[tuple[float, int, threading.Event]] = []
        self._order = itertools.count()

    def now(self) -> float:
        return self._now

    def sleep(self, seconds: float) -> None:
        """Let time pass.

        Raises
        ------
        StoppedClock
            If nobody lets it.
        """
        if not seconds > 0:
            return
        woken = threading.Event()
        with self._lock:
            due = self._now + seconds
            heapq.heappush(self._sleepers, (due, next(self._order), woken))
            self._leave()
        if not _waited(woken, self._patience_s):
            raise StoppedClock(
                f"the virtual clock stands at {self._now:g} s: somebody who counts as at work neither sleeps nor ends, "
                "or waits for other threads outside of together()"
            )

    def together(self, pool: Executor, tasks: Sequence[Callable[[], T]], until: float | None = None) -> list[Future[T]]:
        left = len(tasks)
        if not left:
            return []
        ended = [False] * left
        woken = threading.Event()
        with self._lock:
            self._at_work += left
            if until is not None:
                heapq.heappush(self._sleepers, (max(until, self._now), next(self._order), woken))
            self._leave()

        def attended(number: int, task: Callable[[], T]) -> T:
            nonlocal left
            try:
                return task()
            finally:
                with self._lock:
                    left, ended[number] = left - 1, True
                    if left or woken.is_set():
                        self._leave()
                    else:
                        woken.set()

        futures = [pool.submit(attended, number, task) for number, task in enumerate(tasks)]
        woken.wait()
        with self._lock:
            over = [future for future, done in zip(futures, ended, strict=True) if done]
        wait(over)
        return futures

    def alarm(self, seconds: float, ring: Callable[[], None]) -> AbstractContextManager[None]:
        return nullcontext()

    def _leave(self) -> None:
        """One fewer is at work; if it was the last, move on and wake those whose time has come."""
        self._at_work -= 1
        if self._at_work > 0:
            return
        self._forget_the_woken()
        if not self._sleepers:
            return
        self._now = max(self._now, self._sleepers[0][0])
        while self._sleepers and self._sleepers[0][0] <= self._now:
            self._at_work += 1
            heapq.heappop(self._sleepers)[2].set()
            self._forget_the_woken()

    def _forget_the_woken(self) -> None:
        """A deadline of `together` that was not needed is passed over."""
        while self._sleepers and self._sleepers[0][2].is_set():
            heapq.heappop(self._sleepers)
