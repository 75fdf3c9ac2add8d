"""What a detector finds in a picture, whatever it looks for."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import UInt8

__all__ = ["Detection", "Detector"]


@dataclass(frozen=True)
class Detection:
    """Something in a picture that may be a target.

    Attributes
    ----------
    pixel : (float, float)
        ``u`` to the right, ``v`` down, whole numbers at the centres of pixels, of the point that stands for it.
    height_m : float
        How high above the floor that point is, in metres.
    kind : str
        What was detected, such as ``marker`` or ``blob``.
    identity : int or str or None
        Which one it is: a marker's number, or a target's name; ``None`` where the picture does not tell.
    confidence : float
        From 0 to 1, as far as the detector can tell.
    size_px : float
        Its size in pixels: of a marker the mean side, else the square root of the area.
    """

    pixel: tuple[float, float]
    height_m: float
    kind: str
    identity: int | str | None
    confidence: float
    size_px: float


@runtime_checkable
class Detector(Protocol):
    """Looks at one picture at a time and remembers nothing, so that several threads may share it."""

    def detect(self, picture: UInt8[np.ndarray, "height width 3"]) -> tuple[Detection, ...]:
        """What is in a picture (blue, green, red)."""
