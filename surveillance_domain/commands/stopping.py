"""Stopping when somebody asks for it, with Ctrl-C or SIGTERM, and not in the middle of a step."""

from __future__ import annotations

import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

__all__ = ["Stop", "stop_when_asked", "until_stopped"]


_TWICE_S = 1.0
"""Two signals within so little time are one: some tools signal a process, and then its group once more."""


class Stop:
    """Whether somebody asked, and by which signal."""

    def __init__(self) -> None:
        self.signal: signal.Signals | None = None
        self._asked = threading.Event()

    @property
    def asked(self) -> bool:
        return self._asked.is_set()

    def ask(self, number: signal.Signals | None = None) -> None:
        """Ask for the end."""
        self.signal = number
        self._asked.set()

    def wait(self, seconds: float | None) -> None:
        """Come back when it is asked for, or after some seconds."""
        self._asked.wait(seconds)


@contextmanager
def stop_when_asked() -> Iterator[Stop]:
    """For the main thread: SIGINT and SIGTERM ask for the end; a second one, a moment later, interrupts at once."""
    stop = Stop()
    asked_s = 0.0

    def ask(number: int, frame: FrameType | None) -> None:
        nonlocal asked_s
        now = time.monotonic()
        if not stop.asked:
            asked_s = now
            stop.ask(signal.Signals(number))
        elif now - asked_s >= _TWICE_S:
            raise KeyboardInterrupt

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def until_stopped(seconds: float | None = None) -> None:
    """Come back after some seconds (``None``: never), or at SIGINT or SIGTERM; to be called in the main thread."""
    with stop_when_asked() as stop:
        stop.wait(seconds)
