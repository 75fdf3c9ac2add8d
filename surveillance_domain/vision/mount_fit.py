"""A camera's mount and focal length, from points of the floor seen in any of its presets.

One fit serves all presets, those too in which no point was seen: between presets the camera's own pan, tilt and zoom
tell how it turned. A pan offset is the same as another orientation of the mount, so it is in the fitted angles.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.optics import orientation
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.homography import CalibrationError
from surveillance_domain.vision.points import FloorPoint, PointFit, PointResidual, judged, residuals

__all__ = ["MountFit", "fit_mount"]

_SIGMA_PX = 1.5
_LEAST_MISFIT_PX = 5.0
_YAW_STEP_DEG = 5.0
_FAR_PX = 100.0
_ANGLES = ("yaw_deg", "pitch_deg", "roll_deg")
_SIGMAS = np.array([90.0, 5.0, 5.0, 0.1, 0.3, 0.3, 0.3])
"""How far from the site's numbers the truth may well be: degrees, log of the focal length, metres."""


@dataclass(frozen=True, eq=False)
class MountFit(PointFit):
    """How a camera hangs, and how its points fit that.

    Attributes
    ----------
    camera : Camera
        With the fitted mount and ``zoom_hfov``, and without homographies.
    before : tuple of PointResidual
        The same points with the camera as the site had it.
    focal_scale : float
        New focal length / old one.
    """

    camera: Camera
    before: tuple[PointResidual, ...]
    focal_scale: float


def fit_mount(camera: Camera, points: Sequence[FloorPoint], focal: bool = True, position: bool = False) -> MountFit:
    """Robust least squares of rays against points, then once more over the points that fit.

    Weak ties to the site's numbers (5 degrees of pitch and roll, a tenth of the focal length, 0.3 m of position; yaw is
    as good as free) decide what the points leave open. A ray is compared with its point by the chord of the
    angle between them times the focal length, which grows behind the camera too; so yaw may be all wrong at the start.

    Parameters
    ----------
    camera : Camera
    points : sequence of FloorPoint
        At least two.
    focal, position : bool
        Whether focal length and position are fitted, beside yaw, pitch and roll.

    Raises
    ------
    CalibrationError
        With fewer than two points.
    """
    from scipy.optimize import least_squares

    if len(points) < 2:
        raise CalibrationError(f"{len(points)} points; the mount takes at least 2, better 6 over several presets")
    free = np.array([True, True, True, focal, position, position, position])
    rays = _Rays(camera, points)

    def misses(numbers: Float[np.ndarray, " free"], counted: Bool[np.ndarray, " points"]) -> Float[np.ndarray, " any"]:
        change = np.zeros(len(_SIGMAS))
        change[free] = numbers
        return np.concatenate([rays.misses_px(change)[counted].ravel() / _SIGMA_PX, numbers / _SIGMAS[free]])

    everything = np.ones(len(points), dtype=bool)
    start = np.zeros(int(free.sum()))
    start[0] = _nearest_yaw(rays)
    numbers = least_squares(misses, start, loss="cauchy", x_scale=_SIGMAS[free], args=(everything,)).x
    change = np.zeros(len(_SIGMAS))
    change[free] = numbers
    fits = _fitting(np.linalg.norm(rays.misses_px(change), axis=1))
    change[free] = least_squares(misses, numbers, x_scale=_SIGMAS[free], args=(fits,)).x
    made = _changed(camera, change)
    return MountFit(judged(_residuals(made, points), fits), made, _residuals(camera, points), float(np.exp(change[3])))


class _Rays:
    """Pixels as rays in the camera's own frame, against the directions of their points."""

    def __init__(self, camera: Camera, points: Sequence[FloorPoint]) -> None:
        presets = {preset.name: preset for preset in camera.presets}
        at = [presets[point.preset] for point in points]
        self._mount = camera.mount
        self._places = np.array([(*point.place_m, point.height_m) for point in points])
        views = [pinhole(camera, one.pan, one.tilt, one.zoom) for one in at]
        centre = np.array(views[0].centre_px)
        self._focal_px = np.array([view.focal_px for view in views])
        self._left_up_px = centre - np.array([point.pixel for point in points])
        level = orientation(camera.mount, 0.0, 0.0)
        self._turned = np.stack([level.T @ orientation(camera.mount, one.pan, one.tilt) for one in at])

    def misses_px(self, change: Float[np.ndarray, "7"]) -> Float[np.ndarray, "points 3"]:
        """Chords between the unit vectors towards points and along rays, times the focal length."""
        mount = self._mount.model_copy(
            update={key: getattr(self._mount, key) + float(change[n]) for n, key in enumerate(_ANGLES)}
        )
        away = self._places - (np.asarray(mount.position_m) + change[4:7])
        seen = np.einsum("pi,pij->pj", away @ orientation(mount, 0.0, 0.0), self._turned)
        focal = self._focal_px * np.exp(change[3])
        rays = np.column_stack([focal, self._left_up_px])
        unit = [vectors / np.linalg.norm(vectors, axis=1, keepdims=True) for vectors in (seen, rays)]
        chord: Float[np.ndarray, "points 3"] = (unit[0] - unit[1]) * focal[:, None]
        return chord


def _nearest_yaw(rays: _Rays) -> float:
    """The turn, among those of whole steps, that brings most points near to their rays; of equals the least."""
    turns = np.arange(-180.0, 180.0, _YAW_STEP_DEG)
    away = [np.linalg.norm(rays.misses_px(np.array([turn, 0, 0, 0, 0, 0, 0])), axis=1) for turn in turns]
    costs = np.log1p((np.array(away) / _FAR_PX) ** 2).sum(axis=1)
    return float(turns[np.lexsort([np.abs(turns), costs])[0]])


def _fitting(misses_px: Float[np.ndarray, " points"]) -> Bool[np.ndarray, " points"]:
    """Those within three robust standard deviations, or within 5 pixels."""
    spread = 1.4826 * float(np.median(misses_px))
    fits: Bool[np.ndarray, " points"] = misses_px <= max(_LEAST_MISFIT_PX, 3 * spread)
    return fits


def _changed(camera: Camera, change: Float[np.ndarray, "7"]) -> Camera:
    mount = camera.mount
    angles = {key: _turned(getattr(mount, key) + change[n]) for n, key in enumerate(_ANGLES)}
    x, y, height = (round(float(old + new), 4) for old, new in zip(mount.position_m, change[4:7], strict=True))
    scale = np.exp(change[3])
    hfov = [(zoom, _narrowed(angle, scale)) for zoom, angle in camera.zoom_hfov]
    placed = mount.model_copy(update={**angles, "position_m": (x, y, max(height, 0.0))})
    changes = {"mount": placed, "zoom_hfov": tuple(hfov), "presets": _without_homographies(camera)}
    return camera.model_copy(update=changes)


def _without_homographies(camera: Camera) -> tuple[Preset, ...]:
    return tuple(preset.model_copy(update={"homography": None}) for preset in camera.presets)


def _turned(angle_deg: float) -> float:
    """Between -180 and 180 degrees, to a ten-thousandth."""
    return round(float((angle_deg + 180) % 360 - 180), 4)


def _narrowed(hfov_deg: float, scale: float) -> float:
    """The field of view of a longer focal length."""
    half = np.tan(np.radians(hfov_deg) / 2) / scale
    return round(float(2 * np.degrees(np.arctan(half))), 4)


def _residuals(camera: Camera, points: Sequence[FloorPoint]) -> tuple[PointResidual, ...]:
    size = (camera.image.width, camera.image.height)
    plain = camera.model_copy(update={"presets": _without_homographies(camera)})
    grounds = {one.name: ground(plain, Position(one.pan, one.tilt, one.zoom), size) for one in plain.presets}
    return residuals(points, grounds)
