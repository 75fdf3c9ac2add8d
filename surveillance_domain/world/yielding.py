"""People come first: a camera that somebody else moves, or holds, gets no commands."""

from __future__ import annotations

from collections.abc import Collection

from surveillance_domain.cameras.base import Position

__all__ = ["Yielding"]


class Yielding:
    """Watches one camera for moves that nobody here asked for.

    Parameters
    ----------
    tolerance_deg : float
        How far a camera may be from where it was left, and still count as there.
    yield_s : float
        How long it must be still, once it moved by itself, before it is commanded again.
    """

    def __init__(self, tolerance_deg: float, yield_s: float) -> None:
        self._tolerance_deg, self._yield_s = tolerance_deg, yield_s
        self._left_at: Position | None = None
        self._still_since: float | None = None
        self._last: Position | None = None

    @property
    def yields(self) -> bool:
        """Whether somebody else has it."""
        return self._still_since is not None

    def left_at(self, position: Position | None) -> None:
        """It reached where it was sent; ``None``: it was sent somewhere, failed, or is held, and may be anywhere."""
        self._left_at = position

    def found_at(self, position: Position, now_s: float) -> None:
        """Where it was found to look."""
        if self._still_since is not None:
            if self._last is None or not position.agrees(self._last, self._tolerance_deg):
                self._still_since = now_s
            elif now_s - self._still_since >= self._yield_s:
                self._still_since = None
        elif self._left_at is not None and not position.agrees(self._left_at, self._tolerance_deg):
            self._still_since = now_s
        self._last = position
        self._left_at = position if self._still_since is None and self._left_at is not None else None


def taken(watched: dict[str, Yielding], held: Collection[str]) -> dict[str, str]:
    """Cameras that get no commands, and why."""
    return {
        name: "held" if name in held else "moved by somebody else"
        for name, one in watched.items()
        if name in held or one.yields
    }
