"""The homography of one preset, from points of the floor seen in its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.camera import Camera
from surveillance_domain.vision.ground import Ground
from surveillance_domain.vision.opencv import opencv
from surveillance_domain.vision.points import FloorPoint, PointFit, judged, residuals

__all__ = ["CalibrationError", "HomographyFit", "LEAST_POINTS", "fit_homography"]

LEAST_POINTS = 4
"""Points that determine a homography; more are needed to check it."""

_FITS_PX = 5.0
_FLAT = 1e-3


class CalibrationError(ValueError):
    """The points do not determine what was asked for."""


@dataclass(frozen=True, eq=False)
class HomographyFit(PointFit):
    """A preset's way from picture to floor.

    Attributes
    ----------
    preset : str
    ground : Ground
        Its ``to_floor`` is the homography.
    """

    preset: str
    ground: Ground

    @property
    def checked(self) -> bool:
        """Whether there are more points than determine it, so that the residuals say something."""
        return sum(one.fits for one in self.points) > LEAST_POINTS


def fit_homography(camera: Camera, preset: str, points: Sequence[FloorPoint]) -> HomographyFit:
    """Least squares in the picture, over those points that agree with one another within 5 pixels.

    Points above the floor are first brought down to it along their rays, by the mount's position.

    Raises
    ------
    CalibrationError
        With fewer than four points, or when they lie on one line.
    """
    cv2 = opencv()
    mine = [point for point in points if point.preset == preset]
    if len(mine) < LEAST_POINTS:
        raise CalibrationError(
            f'preset "{preset}": {len(mine)} points; a homography takes at least {LEAST_POINTS}: give more that it '
            "sees, or fit the mount for all presets (--mount), which takes fewer"
        )
    position = np.asarray(camera.mount.position_m, dtype=float)
    pixels, floor = np.array([point.pixel for point in mine]), _on_floor(mine, position)
    if _flatness(floor) < _FLAT or _flatness(pixels) < _FLAT:
        raise CalibrationError(f'preset "{preset}": all points lie on one line; a homography takes four corners')
    method = cv2.RANSAC if len(mine) > LEAST_POINTS else 0
    to_picture, good = cv2.findHomography(floor, pixels, method, _FITS_PX, maxIters=10_000, confidence=0.9999)
    if to_picture is None or abs(np.linalg.det(to_picture)) < 1e-12:
        raise CalibrationError(f'preset "{preset}": no homography fits these points: three may lie on one line')
    fits = good.ravel().astype(bool)
    if fits.sum() > LEAST_POINTS:
        to_picture, _ = cv2.findHomography(floor[fits], pixels[fits], 0)
    to_floor = _seeing(np.linalg.inv(to_picture), pixels[fits])
    ground = Ground(to_floor, position, (camera.image.width, camera.image.height), calibrated=True)
    return HomographyFit(judged(residuals(mine, {preset: ground}), fits), preset, ground)


def _on_floor(points: Sequence[FloorPoint], position_m: Float[np.ndarray, "3"]) -> Float[np.ndarray, "points 2"]:
    places, heights = np.array([one.place_m for one in points]), np.array([one.height_m for one in points])
    high = [one.name for one in points if one.height_m >= position_m[2]]
    if high:
        raise CalibrationError(f"{', '.join(high)}: as high as the camera or higher; expected points below it")
    return position_m[:2] + (places - position_m[:2]) / (1 - heights / position_m[2])[:, None]


def _flatness(points: Float[np.ndarray, "points 2"]) -> float:
    """0 for points on one line, up to 1."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return float(spread[1] / spread[0]) if spread[0] > 0 else 0.0


def _seeing(to_floor: Float[np.ndarray, "3 3"], pixels: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "3 3"]:
    """Scaled to a determinant of 1 or -1, with ``w > 0`` at pixels that see the floor."""
    weights = np.column_stack([pixels, np.ones(len(pixels))]) @ to_floor[2]
    size = np.cbrt(np.abs(np.linalg.det(to_floor)))
    scaled: Float[np.ndarray, "3 3"] = to_floor / (size * np.sign(np.median(weights)))
    return scaled
