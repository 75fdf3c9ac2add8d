"""What the privacy masks that are set in a camera hide: directions, told in the camera's own pan and tilt."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.model.optics import orientation
from surveillance_domain.site.camera import Camera, Mount, PrivacyMask

__all__ = ["behind_masks", "masked_points", "own_angles"]

_ROUNDING_DEG = 1e-9


def masked_points(camera: Camera, points_m: Float[np.ndarray, "points 3"]) -> Bool[np.ndarray, " points"]:
    """Which points in the world, x, y and height in metres, lie behind one of a camera's masks."""
    return behind_masks(camera, points_m - np.asarray(camera.mount.position_m))


def behind_masks(camera: Camera, rays: Float[np.ndarray, "rays 3"]) -> Bool[np.ndarray, " rays"]:
    """Which directions in the world, of any length, lie behind one of a camera's masks; edges are behind it."""
    hidden = np.zeros(len(rays), dtype=bool)
    if camera.privacy_masks:
        pan, tilt = own_angles(camera.mount, rays)
        for mask in camera.privacy_masks:
            hidden |= _covers(mask, pan, tilt) | _covers(mask, pan + 180, 180 - tilt)
    return hidden


def own_angles(
    mount: Mount, rays: Float[np.ndarray, "rays 3"]
) -> tuple[Float[np.ndarray, " rays"], Float[np.ndarray, " rays"]]:
    """Pan and tilt, in the camera's own degrees, at which its optical axis lies along directions in the world.

    The pan is between -180 and 180, the tilt between -90 and 90. A camera that tilts beyond the vertical can lie along
    the same direction with ``pan + 180`` and ``180 - tilt``.
    """
    forward, left, up = (rays @ orientation(mount, 0.0, 0.0)).T
    pan = np.degrees(np.arctan2(left, forward))
    return -pan if mount.pan_clockwise else pan, np.degrees(np.arctan2(up, np.hypot(forward, left)))


def _covers(
    mask: PrivacyMask, pan: Float[np.ndarray, " rays"], tilt: Float[np.ndarray, " rays"]
) -> Bool[np.ndarray, " rays"]:
    """Whether own pan and tilt, each the same after a whole turn, lie in the rectangle."""
    inside: Bool[np.ndarray, " rays"] = _between(pan, *mask.pan_deg) & _between(tilt, *mask.tilt_deg)
    return inside


def _between(angle: Float[np.ndarray, " rays"], first: float, last: float) -> Bool[np.ndarray, " rays"]:
    """Whether an angle is met on the way from the first, rising, to the last."""
    met: Bool[np.ndarray, " rays"] = (angle - first + _ROUNDING_DEG) % 360 <= (last - first) % 360 + 2 * _ROUNDING_DEG
    return met
