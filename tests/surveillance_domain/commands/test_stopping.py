"""Stopping when asked: two signals at once are one, a later one interrupts."""

from __future__ import annotations

import os
import signal
import time

import pytest

from surveillance_domain.commands.stopping import stop_when_asked


@pytest.mark.example
def test_two_signals_at_once_are_one(monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(time, "monotonic", lambda: now)
    with stop_when_asked() as stop:
        os.kill(os.getpid(), signal.SIGINT)
        os.kill(os.getpid(), signal.SIGINT)
        assert stop.asked
        assert stop.signal is signal.SIGINT
        now = 101.0
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGINT)
