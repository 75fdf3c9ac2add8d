"""When a camera is left alone: after three failures in a row, and after a refused log-in."""

from __future__ import annotations

from collections.abc import Iterable

from surveillance_domain.cameras.clock import Clock

__all__ = ["Breaker", "Lockout"]


class Breaker:
    """Opens for half a minute when a camera fails three times in a row; then one question decides.

    Parameters
    ----------
    clock : Clock
    failures : int
        In a row, until it opens.
    open_s : float
        How long it stays open.
    """

    def __init__(self, clock: Clock, failures: int = 3, open_s: float = 30.0) -> None:
        self._clock, self._most, self._open_s = clock, failures, open_s
        self._in_a_row = 0
        self._until = 0.0

    @property
    def until(self) -> float | None:
        """When it may be asked again, if that is not yet; ``None`` if it may."""
        return self._until if self._in_a_row >= self._most and self._clock.now() < self._until else None

    @property
    def half_open(self) -> bool:
        """Whether the time is over but it has not answered since."""
        return self._in_a_row >= self._most and self.until is None

    def failed(self) -> None:
        """One more failure; the one that opens it, and each after that, starts the time anew."""
        self._in_a_row += 1
        if self._in_a_row >= self._most:
            self._until = self._clock.now() + self._open_s

    def succeeded(self) -> None:
        """It answered: closed."""
        self._in_a_row = 0


class Lockout:
    """Ten minutes without a word after the second 401 in a row, then one try: cameras lock users out for less.

    Parameters
    ----------
    clock : Clock
    pause_s : float
    """

    def __init__(self, clock: Clock, pause_s: float = 600.0) -> None:
        self._clock, self._pause_s = clock, pause_s
        self._in_a_row = 0
        self._until = 0.0

    @property
    def until(self) -> float | None:
        """When the log-in may be tried again, if that is not yet; ``None`` if it may."""
        return self._until if self._in_a_row >= 2 and self._clock.now() < self._until else None

    def heard(self, statuses: Iterable[int]) -> None:
        """The statuses of one exchange in their order: the challenge, and what came of its answer."""
        for status in statuses:
            self._in_a_row = self._in_a_row + 1 if status == 401 else 0
        if self._in_a_row >= 2:
            self._until = self._clock.now() + self._pause_s
