"""How large markers are in a picture: whether a camera can read them at all."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.pinhole import Pinhole, pinhole
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.site.sections import Markers

__all__ = ["LEAST_SIDE_PX", "marker_side_px", "marker_sides_px"]

LEAST_SIDE_PX = 24.0
"""Mean side of a marker in pixels to design for: above it, one in plain view is read (benchmarks/detection.py)."""


def marker_sides_px(
    view: Pinhole, markers: Markers, places_m: Float[np.ndarray, "places 2"]
) -> Float[np.ndarray, " places"]:
    """Mean side in pixels of markers that lie level, turned squarely to the camera, on targets at some places.

    nan where a corner is behind the camera. Whether they lie within the picture is not asked.
    """
    away = places_m - view.position_m[:2]
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    forward = np.where(distance > 0, away / np.where(distance > 0, distance, 1.0), [1.0, 0.0])
    left = forward @ np.array([[0.0, 1.0], [-1.0, 0.0]])
    half = markers.side_m / 2
    corners = [places_m + half * (f * forward + s * left) for f, s in ((1, 1), (1, -1), (-1, -1), (-1, 1))]
    height = np.full((len(places_m), 1), markers.height_m)
    pixels = np.stack([view.project(np.hstack([corner, height])) for corner in corners])
    sides: Float[np.ndarray, " places"] = np.linalg.norm(pixels - np.roll(pixels, 1, axis=0), axis=2).mean(axis=0)
    return sides


def marker_side_px(camera: Camera, preset: Preset, markers: Markers, distance_m: float) -> float:
    """Mean side in pixels of a level marker straight ahead of a preset, at a distance over the floor.

    Parameters
    ----------
    camera : Camera
    preset : Preset
    markers : Markers
    distance_m : float
        From the point below the camera to the target, in metres.
    """
    view = pinhole(camera, preset.pan, preset.tilt, preset.zoom)
    ahead = view.axes[:2, 0]
    length = float(np.linalg.norm(ahead))
    ahead = ahead / length if length > 0 else np.array([1.0, 0.0])
    place = view.position_m[:2] + distance_m * ahead
    return float(marker_sides_px(view, markers, place[None, :])[0])
