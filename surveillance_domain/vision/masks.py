"""What was detected behind a declared privacy mask is not used, whether or not the camera hides it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.privacy_masks import behind_masks
from surveillance_domain.site.camera import Camera
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.ground import view_at

__all__ = ["unmasked"]


def unmasked(
    camera: Camera, position: Position, size: tuple[int, int], detections: Sequence[Detection]
) -> Sequence[Detection]:
    """Those detections whose pixel does not look behind one of the camera's masks.

    Parameters
    ----------
    camera : Camera
    position : Position
        As it was read back when the picture was taken.
    size : (int, int)
        Width and height of the picture in pixels.
    detections : sequence of Detection
    """
    if not camera.privacy_masks or not detections:
        return detections
    pixels = np.array([one.pixel for one in detections], dtype=float)
    hidden = behind_masks(camera, view_at(camera, position, size).rays(pixels))
    return [one for one, behind in zip(detections, hidden, strict=True) if not behind]
