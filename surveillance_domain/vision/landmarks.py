"""Points that a calibration was made from, kept to be looked for again: pan drifts, and mounts are knocked.

A marker is found by its number. Any other point is found by what lay around it: a grey patch, searched for in a window
about where it was by normalised cross-correlation (Lewis, "Fast template matching", 1995), as OpenCV has it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import UInt8

from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.opencv import opencv
from surveillance_domain.vision.points import FloorPoint

__all__ = ["Landmark", "found_again", "landmarks"]

_HALF_PX = 16
_WINDOW_PX = 80
"""How far a point may have moved in the picture and still be found; markers are found anywhere."""
_LEAST_CONTRAST = 6.0
"""Standard deviation of grey, of 255, below which a patch is too plain to be told from its surroundings."""
_LEAST_SCORE = 0.7


@dataclass(frozen=True, eq=False)
class Landmark:
    """A point of the floor that was calibrated from.

    Attributes
    ----------
    point : FloorPoint
        Where it was seen, and where it lies.
    patch : (33, 33) uint8 or None
        The grey picture around it; ``None`` for markers, and where there was no picture or nothing to be told apart.
    """

    point: FloorPoint
    patch: UInt8[np.ndarray, "side side"] | None = None


def landmarks(points: Sequence[FloorPoint], pictures: Mapping[str, np.ndarray]) -> tuple[Landmark, ...]:
    """Those of the points that can be found again.

    Parameters
    ----------
    points : sequence of FloorPoint
    pictures : mapping of str to (height, width, 3) uint8
        By preset, blue, green and red, of the size that the site gives.
    """
    found = []
    for point in points:
        if point.marker is not None:
            found.append(Landmark(point))
        elif point.preset in pictures:
            patch = _patch(pictures[point.preset], point.pixel)
            if patch is not None:
                found.append(Landmark(point, patch))
    return tuple(found)


def found_again(
    known: Sequence[Landmark], picture: UInt8[np.ndarray, "height width 3"], detections: Sequence[Detection]
) -> tuple[FloorPoint | None, ...]:
    """For each landmark of one preset the point with the pixel at which it is seen now; ``None`` where it is not.

    Parameters
    ----------
    known : sequence of Landmark
    picture : (height, width, 3) uint8
        In the size that the site gives.
    detections : sequence of Detection
        Of markers, in that picture.
    """
    grey = opencv().cvtColor(picture, opencv().COLOR_BGR2GRAY)
    markers = {one.identity: one.pixel for one in detections}
    found: list[FloorPoint | None] = []
    for one in known:
        pixel = markers.get(one.point.marker) if one.patch is None else _searched(grey, one.patch, one.point.pixel)
        found.append(None if pixel is None else replace(one.point, pixel=pixel))
    return tuple(found)


def _patch(picture: np.ndarray, pixel: tuple[float, float]) -> np.ndarray | None:
    cv2 = opencv()
    u, v = (round(part) for part in pixel)
    height, width = picture.shape[:2]
    if not (_HALF_PX <= u < width - _HALF_PX and _HALF_PX <= v < height - _HALF_PX):
        return None
    around = picture[v - _HALF_PX : v + _HALF_PX + 1, u - _HALF_PX : u + _HALF_PX + 1]
    grey: np.ndarray = cv2.cvtColor(around, cv2.COLOR_BGR2GRAY)
    return grey if grey.std() >= _LEAST_CONTRAST else None


def _searched(grey: np.ndarray, patch: np.ndarray, pixel: tuple[float, float]) -> tuple[float, float] | None:
    """Where a patch is in a picture, as far from the patch's middle as the point was."""
    cv2 = opencv()
    u, v = (round(part) for part in pixel)
    reach = _HALF_PX + _WINDOW_PX
    top, left = max(v - reach, 0), max(u - reach, 0)
    window = grey[top : v + reach + 1, left : u + reach + 1]
    if window.shape[0] < patch.shape[0] or window.shape[1] < patch.shape[1]:
        return None
    _, score, _, (column, row) = cv2.minMaxLoc(cv2.matchTemplate(window, patch, cv2.TM_CCOEFF_NORMED))
    if score < _LEAST_SCORE:
        return None
    return left + column + _HALF_PX + pixel[0] - u, top + row + _HALF_PX + pixel[1] - v
