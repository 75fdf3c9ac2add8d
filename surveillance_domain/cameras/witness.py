"""Whoever follows what a camera is asked and what it tells of its position, and may forbid commands."""

from __future__ import annotations

from surveillance_domain.cameras.base import Position

__all__ = ["MOVED", "Witness"]

MOVED = "moved by somebody else"
"""Why a camera gets no commands, though nobody said that it is held."""


class Witness:
    """Hears everything as it happens, in the camera's own thread; this one makes nothing of it."""

    @property
    def yields(self) -> bool:
        """Whether somebody else has the camera: then no move is asked of it."""
        return False

    def sent(self, goal: Position, now_s: float) -> None:
        """A move is about to be asked; whether that comes through is not known yet."""

    def accepted(self, goal: Position) -> None:
        """The camera took the command, or stands there already."""

    def read(self, position: Position, asked_s: float, now_s: float) -> None:
        """It told its position, at some time between the question and the answer."""

    def failed(self) -> None:
        """It did not answer as it should; it may have rebooted."""
