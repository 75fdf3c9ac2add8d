"""A worker that dies."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable
from threading import Thread
from typing import Any

import pytest

WORDS = ("compare", "micro", "--targets", "1", "--controllers", "sys", "--runs", 5000, "--workers", 2)


def kill_one(patience_s: float = 120.0) -> None:
    """End a worker once all are there, as a system short of memory does."""
    until = time.monotonic() + patience_s
    while time.monotonic() < until:
        workers = multiprocessing.active_children()
        if len(workers) == 2:
            workers[0].kill()
            return
        time.sleep(0.05)


@pytest.mark.end_to_end
def test_a_killed_worker_is_one_message(surveillance: Callable[..., Any]) -> None:
    killer = Thread(target=kill_one)
    killer.start()
    answer = surveillance(*WORDS)
    killer.join()
    assert answer.code == 2
    assert "a worker process was killed" in answer.err
    assert "give fewer --workers" in answer.err
    assert answer.out == ""
    assert "Traceback" not in answer.err
