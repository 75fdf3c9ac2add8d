"""The pinhole camera: from a mount and a preset to what projects into the picture, and how deep it counts.

Frames: the world has x right, y up (north) and z to the ceiling, in metres; a camera looks along its *forward* axis,
with *left* and *up* beside it. The orientation is the product of turns, outermost first: mount yaw (about z), mount
pitch (forward goes up), mount roll (left goes up), 180 degrees of roll if the mount is inverted, then pan about the
camera's own up axis (clockwise seen along it from above, unless ``pan_clockwise = false``) and tilt (forward goes up).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.camera import Camera, Mount, Preset

__all__ = ["depth_m", "horizontal_fov_deg", "in_picture", "orientation", "reach_m", "within_depth"]

_ROUNDING = 1e-9


def horizontal_fov_deg(zoom_hfov: Sequence[tuple[float, float]], zoom: float) -> float:
    """Horizontal field of view in degrees at a zoom position, the focal length interpolated between the pairs.

    The focal length in units of half the picture's width is ``1 / tan(hfov / 2)``.
    """
    zooms, angles = np.array(zoom_hfov, dtype=np.float64).T
    focal = float(np.interp(zoom, zooms, 1 / np.tan(np.radians(angles) / 2)))
    return float(np.degrees(2 * np.arctan(1 / focal)))


def orientation(mount: Mount, pan_deg: float, tilt_deg: float) -> Float[np.ndarray, "3 3"]:
    """The camera's axes in the world, as columns forward, left, up."""
    pan = -pan_deg if mount.pan_clockwise else pan_deg
    roll = mount.roll_deg + (180 if mount.inverted else 0)
    placed = _about_up(mount.yaw_deg) @ _forward_up(mount.pitch_deg) @ _about_forward(roll)
    return placed @ _about_up(pan) @ _forward_up(tilt_deg)


def _about_up(angle_deg: float) -> Float[np.ndarray, "3 3"]:
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])


def _forward_up(angle_deg: float) -> Float[np.ndarray, "3 3"]:
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[cosine, 0, -sine], [0, 1, 0], [sine, 0, cosine]])


def _about_forward(angle_deg: float) -> Float[np.ndarray, "3 3"]:
    cosine, sine = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    return np.array([[1, 0, 0], [0, cosine, -sine], [0, sine, cosine]])


def depth_m(camera: Camera, preset: Preset) -> float:
    """How deep the field of view counts, in metres along the optical axis.

    ``width / (2 px_per_m tan(hfov / 2))`` (EN 62676-4), or ``max_depth_m``, whichever is smaller.
    """
    limits = [] if camera.max_depth_m is None else [camera.max_depth_m]
    if camera.required_px_per_m is not None:
        half_width = _half_extent(camera, preset)[0]
        limits.append(camera.image.width / (2 * camera.required_px_per_m * half_width))
    return min(limits, default=float("inf"))


def _half_extent(camera: Camera, preset: Preset) -> tuple[float, float]:
    """Half the picture's width and height at unit distance along the optical axis."""
    half_width = float(np.tan(np.radians(horizontal_fov_deg(camera.zoom_hfov, preset.zoom)) / 2))
    return half_width, half_width * camera.image.height / camera.image.width


def _seen_from(
    camera: Camera, preset: Preset, points_m: Float[np.ndarray, "points 3"]
) -> Float[np.ndarray, "points 3"]:
    """Points in the camera's frame: forward, left, up, in metres."""
    axes = orientation(camera.mount, preset.pan, preset.tilt)
    return (points_m - np.asarray(camera.mount.position_m)) @ axes


def in_picture(camera: Camera, preset: Preset, points_m: Float[np.ndarray, "points 3"]) -> Bool[np.ndarray, " points"]:
    """Which points project into the picture, at whatever distance and whatever stands between."""
    forward, left, up = _seen_from(camera, preset, points_m).T
    half_width, half_height = _half_extent(camera, preset)
    across = np.abs(left) <= half_width * forward + _ROUNDING
    along = np.abs(up) <= half_height * forward + _ROUNDING
    return (forward > 0) & across & along


def within_depth(
    camera: Camera, preset: Preset, points_m: Float[np.ndarray, "points 3"]
) -> Bool[np.ndarray, " points"]:
    """Which points are no farther along the optical axis than `depth_m`."""
    return _seen_from(camera, preset, points_m)[:, 0] <= depth_m(camera, preset) + _ROUNDING


def reach_m(camera: Camera, preset: Preset) -> float:
    """The greatest distance of any point within the picture and its depth, in metres."""
    half_width, half_height = _half_extent(camera, preset)
    return depth_m(camera, preset) * float(np.sqrt(1 + half_width**2 + half_height**2))
