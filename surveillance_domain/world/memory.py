"""What is remembered of a camera that somebody moved, for whoever commands it next: a park, or a run started again."""

from __future__ import annotations

from dataclasses import dataclass

from surveillance_domain.cameras.base import Position

__all__ = ["Memory", "Stood", "still_for_s"]

_FORGOTTEN = 10.0
"""Times ``yield_s``: after so long without anybody who looked, a camera elsewhere says nothing of people any more."""


@dataclass(frozen=True)
class Stood:
    """Where a camera stood that somebody moved.

    Attributes
    ----------
    position : Position
    still_s : float
        For how long it has been still there, in seconds, as far as anybody looked.
    """

    position: Position
    still_s: float


class Memory:
    """Of one camera; this one keeps nothing."""

    def recall(self) -> Stood | None:
        """Where it stood when somebody moved it last; ``None``: nobody has it."""
        return None

    def keep(self, stood: Stood | None) -> None:
        """Keep that somebody moved it; ``None``: nobody has it any more. Never raises."""


def still_for_s(memory: Memory, yield_s: float, tolerance_deg: float, position: Position | None) -> float | None:
    """For how long a camera that somebody moved has been still, in seconds; ``None``: it may be commanded.

    Parameters
    ----------
    yield_s : float
        How long it must be still.
    tolerance_deg : float
        Within which two positions are the same.
    position : Position or None
        Where it is now; one that is elsewhere than remembered was moved again. What is remembered changes with that.
        ``None``: that is not known yet, so nobody can say that it has been still.
    """
    stood = memory.recall()
    if stood is None:
        return None
    if stood.still_s >= _FORGOTTEN * yield_s:
        memory.keep(None)
        return None
    if position is None:
        return stood.still_s
    if not position.agrees(stood.position, tolerance_deg):
        memory.keep(Stood(position, 0.0))
        return 0.0
    if stood.still_s >= yield_s:
        memory.keep(None)
        return None
    return stood.still_s
