"""Waiting for the end: until a time is over, or somebody stops the command with Ctrl-C or SIGTERM."""

from __future__ import annotations

import signal
import threading
from types import FrameType

__all__ = ["until_stopped"]


def until_stopped(seconds: float | None = None) -> None:
    """Come back after some seconds (``None``: never), or at SIGINT or SIGTERM; to be called in the main thread."""
    stopped = threading.Event()

    def stop(number: int, frame: FrameType | None) -> None:
        stopped.set()

    before = {number: signal.signal(number, stop) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        stopped.wait(seconds)
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
