"""What became of one camera of a network in one step."""

from __future__ import annotations

from dataclasses import dataclass

from surveillance_domain.cameras.base import Health, Move, Outcome, Position
from surveillance_domain.cameras.errors import CameraAway, CameraError, without_name
from surveillance_domain.cameras.witness import MOVED

__all__ = ["PRIVATE", "CameraReport"]

PRIVATE = "it looks into a private area, so that it is not listened to"
"""Why a camera that answers has no view."""


@dataclass
class CameraReport:
    """What became of one camera in the last step.

    Attributes
    ----------
    camera : str
    health : Health
    sent : str or None
        The preset it was sent to; ``None``: it got no command.
    outcome : str
        Of its move; empty if it got none.
    arrived : bool
        Whether it may be taken to stand still: it got no command, or it did as it was told.
    position : Position or None
        Read back with its look.
    move_s, look_s : float
        How long they took.
    because : str
        What went wrong with it, or why it got no command, without its name; empty if nothing did.
    fault : str
        The kind of error by its class's name, such as ``LoginRefused``; empty if there was none.
    """

    camera: str
    health: Health
    sent: str | None = None
    outcome: str = ""
    arrived: bool = True
    position: Position | None = None
    move_s: float = 0.0
    look_s: float = 0.0
    because: str = ""
    fault: str = ""

    def moved(self, preset: str, move: Move | None) -> None:
        """Note what came of a move; ``None``: it is not over.

        A camera that says it stands where it stood, though it took the command, may be one whose read-back has frozen:
        it is not believed.
        """
        if move is not None and not move.commanded:
            self.move_s = move.seconds
            return
        self.sent = preset
        if move is None:
            self.outcome, self.arrived = str(Outcome.TIMED_OUT), False
            return
        self.outcome, self.move_s = str(move.outcome), move.seconds
        self.because, self.fault = move.because, move.fault
        sent_off = move.outcome is Outcome.TIMED_OUT or (move.outcome is Outcome.STALLED and move.position is not None)
        self.arrived = not sent_off

    def looked(self, position: Position) -> None:
        """Note where it looks; one that answers again in the very step is no longer left alone."""
        self.position = position
        if self.fault == CameraAway.__name__:
            self.because = "not turned in this step: it had been left alone after failures, and answers again"

    def moved_by_others(self) -> None:
        """Note that somebody else moves it, which explains what may have gone wrong meanwhile."""
        self.because, self.fault = MOVED, ""

    def failed(self, problem: CameraError) -> None:
        """Note an error; the first one of a step is kept."""
        self.because = self.because or without_name(problem, self.camera)
        self.fault = self.fault or type(problem).__name__
