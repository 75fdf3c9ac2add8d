"""The homography of one preset, from points of the floor seen in its pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.camera import Camera
from surveillance_domain.vision.ground import Ground
from surveillance_domain.vision.opencv import opencv
from surveillance_domain.vision.points import FloorPoint, PointFit, judged, residuals

__all__ = ["CalibrationError", "HomographyFit", "LEAST_POINTS", "fit_homography"]

LEAST_POINTS = 4
"""Points that determine a homography; more are needed to check it."""

_FITS_PX = 5.0
_FLAT = 1e-3
_HELP = "lay or click more that it sees, not on one line, or fit the mount, which serves all presets (--mount)"


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
        With fewer than four points, when all but one of them lie on one line, or when most do not agree; it says what
        would help.
    """
    cv2 = opencv()
    mine = [point for point in points if point.preset == preset]
    if len(mine) < LEAST_POINTS:
        raise CalibrationError(
            f'preset "{preset}": {len(mine)} points; a homography takes at least {LEAST_POINTS}: {_HELP}'
        )
    position = np.asarray(camera.mount.position_m, dtype=float)
    pixels, floor = np.array([point.pixel for point in mine]), _on_floor(mine, position)
    line = next((found for found in map(_on_one_line, (floor, pixels)) if found is not None), None)
    if line is not None:
        named = (
            "all its points" if line.all() else ", ".join(one.name for one, on in zip(mine, line, strict=True) if on)
        )
        raise CalibrationError(
            f'preset "{preset}": {named} lie on one line; a homography takes two points or more beside it: {_HELP}'
        )
    method = cv2.RANSAC if len(mine) > LEAST_POINTS else 0
    to_picture, good = cv2.findHomography(floor, pixels, method, _FITS_PX, maxIters=10_000, confidence=0.9999)
    if to_picture is None or abs(np.linalg.det(to_picture)) < 1e-12:
        raise CalibrationError(
            f'preset "{preset}": no homography fits its {len(mine)} points: measure their places again, or {_HELP}'
        )
    fits = good.ravel().astype(bool)
    if 2 * fits.sum() < len(mine):
        raise CalibrationError(
            f'preset "{preset}": only {fits.sum()} of {len(mine)} points agree with one another, as any four do: '
            f"measure their places again, or {_HELP}"
        )
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


def _on_one_line(points: Float[np.ndarray, "points 2"]) -> Bool[np.ndarray, " points"] | None:
    """Which points lie on one line, if it is all of them or all but one; otherwise ``None``."""
    everything = np.ones(len(points), dtype=bool)
    for counted in (everything, *(everything & (np.arange(len(points)) != one) for one in range(len(points)))):
        if _flatness(points[counted]) < _FLAT:
            return counted
    return None


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
