"""Since when a camera has stood still, by what it tells of its position."""

from __future__ import annotations

from surveillance_domain.cameras.base import Position

__all__ = ["Steadiness"]


class Steadiness:
    """Remembers since when all positions read back agree.

    Parameters
    ----------
    tolerance_deg : float
        Positions that differ by no more than this are the same.
    """

    def __init__(self, tolerance_deg: float) -> None:
        self._tolerance_deg = tolerance_deg
        self._anchor: Position | None = None
        self._since = 0.0

    def read(self, position: Position, now: float) -> None:
        """One more position; the first that differs from that with which the rest began begins another."""
        if self._anchor is None or not position.agrees(self._anchor, self._tolerance_deg):
            self._anchor, self._since = position, now

    def forget(self) -> None:
        """What happens from here on is not known."""
        self._anchor = None

    def still_s(self, now: float) -> float:
        """For how long it has been still; 0.0 if nothing is known."""
        return now - self._since if self._anchor is not None else 0.0
