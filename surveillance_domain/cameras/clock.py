"""The time that cameras and control loop live by: the wall's, or one that a test lets run many times faster."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future, wait
from contextlib import AbstractContextManager, contextmanager
from typing import Protocol, TypeVar, runtime_checkable

__all__ = ["Clock", "RealClock"]

T = TypeVar("T")


@runtime_checkable
class Clock(Protocol):
    """What everything that waits is given."""

    def now(self) -> float:
        """Seconds from some fixed moment; never less than before."""

    def sleep(self, seconds: float) -> None:
        """Come back when that much time has passed; at once if it is not above 0."""

    def together(self, pool: Executor, tasks: Sequence[Callable[[], T]], until: float | None = None) -> list[Future[T]]:
        """Do tasks at the same time, in threads of a pool that has at least as many free, and wait for all of them.

        A virtual clock moves on only when everybody at work sleeps, so it must know who that is: a thread that waits
        on others must do so here. The futures are done: ``result()`` gives what came out, or raises what was raised;
        but with a deadline, those that were not done ``until`` then go on in their threads.
        """

    def alarm(self, seconds: float, ring: Callable[[], None]) -> AbstractContextManager[None]:
        """Ring, in another thread, if what is done in here takes longer; where no time passes meanwhile, never."""


class RealClock:
    """The wall's time."""

    def now(self) -> float:
        return time.monotonic()

    def sleep(self, seconds: float) -> None:
        if seconds > 0:
            time.sleep(seconds)

    def together(self, pool: Executor, tasks: Sequence[Callable[[], T]], until: float | None = None) -> list[Future[T]]:
        futures = [pool.submit(task) for task in tasks]
        wait(futures, None if until is None else max(0.0, until - self.now()))
        return futures

    @contextmanager
    def alarm(self, seconds: float, ring: Callable[[], None]) -> Iterator[None]:
        timer = threading.Timer(max(seconds, 0.0), ring)
        timer.daemon = True
        timer.start()
        try:
            yield
        finally:
            timer.cancel()
