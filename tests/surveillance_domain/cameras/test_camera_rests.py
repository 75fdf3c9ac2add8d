"""When a camera is left alone, and how often it is asked again."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.cameras.errors import CameraAway, Refused, Unreachable
from surveillance_domain.cameras.rests import Breaker, Lockout
from surveillance_domain.cameras.retry import with_retries
from surveillance_domain.emulation.virtual_clock import VirtualClock


@pytest.mark.example
def test_breaker_opens_at_the_third_failure_in_a_row_and_closes_when_the_camera_answers() -> None:
    clock = VirtualClock(start_s=100.0)
    breaker = Breaker(clock)
    for _ in range(2):
        breaker.failed()
    breaker.succeeded()
    for _ in range(2):
        breaker.failed()
    assert breaker.until is None
    breaker.failed()
    assert breaker.until == 130.0
    assert not breaker.half_open
    clock.sleep(30.0)
    assert breaker.until is None
    assert breaker.half_open
    breaker.failed()
    assert breaker.until == 160.0
    clock.sleep(31.0)
    breaker.succeeded()
    assert breaker.until is None
    assert not breaker.half_open


@pytest.mark.example
def test_lockout_begins_at_the_second_401_in_a_row_and_allows_one_try_after_ten_minutes() -> None:
    clock = VirtualClock()
    lockout = Lockout(clock)
    lockout.heard([401, 200])
    lockout.heard([401])
    assert lockout.until is None
    lockout.heard([401])
    assert lockout.until == 600.0
    clock.sleep(600.0)
    assert lockout.until is None
    lockout.heard([401, 401])
    assert lockout.until == 1200.0
    clock.sleep(600.0)
    lockout.heard([401, 204])
    assert lockout.until is None


class Attempts:
    """Raises what it is given, one after the other, and then answers."""

    def __init__(self, clock: VirtualClock, *errors: Exception) -> None:
        self.clock, self.errors, self.times = clock, list(errors), []

    def __call__(self) -> str:
        self.times.append(self.clock.now())
        if self.errors:
            raise self.errors.pop(0)
        return "answer"


@pytest.mark.example
def test_passing_failures_are_tried_again_with_growing_pauses() -> None:
    clock = VirtualClock()
    attempts = Attempts(clock, *[Unreachable("x")] * 3)
    assert with_retries(attempts, clock, np.random.default_rng(0), until=10.0) == "answer"
    pauses = np.diff(attempts.times)
    assert len(pauses) == 3
    assert all(0.5 * least <= pause <= 1.5 * least for pause, least in zip(pauses, (0.1, 0.2, 0.4), strict=True))
    other = Attempts(clock, *[Unreachable("x")] * 3)
    with_retries(other, clock, np.random.default_rng(1), until=20.0)
    assert not np.allclose(np.diff(other.times), pauses)


@pytest.mark.example
def test_no_retry_ends_after_the_deadline() -> None:
    clock = VirtualClock()
    attempts = Attempts(clock, *[Unreachable("x")] * 9)
    with pytest.raises(Unreachable):
        with_retries(attempts, clock, np.random.default_rng(0), until=0.25)
    assert max(attempts.times) < 0.25
    endless = Attempts(clock, *[Unreachable("x")] * 9)
    with pytest.raises(Unreachable):
        with_retries(endless, clock, np.random.default_rng(0), until=1e9)
    assert len(endless.times) == 4


@pytest.mark.example
@pytest.mark.parametrize("error", [Refused("no"), CameraAway("resting")])
def test_a_refusal_is_not_tried_again(error: Exception) -> None:
    clock = VirtualClock()
    attempts = Attempts(clock, error)
    with pytest.raises(type(error)):
        with_retries(attempts, clock, np.random.default_rng(0), until=10.0)
    assert len(attempts.times) == 1
