"""What looks through the cameras of a network, one camera at a time, and then makes one sighting of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from surveillance_domain.cameras.base import Camera, Position
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.vision.observe import Observed

__all__ = ["Eyes", "Look"]


@dataclass(frozen=True)
class Look:
    """What one camera brought back.

    Attributes
    ----------
    position : Position
        Where it looked, read back with the look itself.
    found : object
        For whoever made it: detections in a picture, say.
    """

    position: Position
    found: Any = None


@runtime_checkable
class Eyes(Protocol):
    """Looks, and says which targets were seen where."""

    def look(self, camera: Camera, budget_s: float) -> Look:
        """Look through one camera, in that camera's own thread; raises `CameraError` where that fails."""

    def seen(
        self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]
    ) -> Observed:
        """What the cameras with a view saw together, those among them that look at no preset of their own."""
