"""Whether a preset's homography and the site's mount tell the same; one of them is wrong where they do not."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.points import root_mean_square

__all__ = ["disagreement_m"]


def disagreement_m(camera: Camera, preset: Preset, places_m: Float[np.ndarray, "places 2"]) -> float:
    """Root mean square distance, in metres, between places and where the homography puts the pixels that show them.

    Parameters
    ----------
    camera : Camera
    preset : Preset
        Of the camera. Without a homography the answer is 0.
    places_m : (places, 2) float
        On the floor, such as the centres of the cells in view; nan comes back if the homography puts one nowhere.
    """
    view = pinhole(camera, preset.pan, preset.tilt, preset.zoom)
    floor = np.column_stack([places_m, np.zeros(len(places_m))])
    pixels = view.project(floor)
    size = (camera.image.width, camera.image.height)
    here = ground(camera, Position(preset.pan, preset.tilt, preset.zoom), size)
    found = here.on_floor(pixels, np.zeros(len(places_m)))
    return root_mean_square(np.linalg.norm(found - places_m, axis=1).tolist())
