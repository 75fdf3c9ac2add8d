"""ArUco markers: squares whose pattern says which one it is.

Garrido-Jurado et al., "Automatic generation and detection of highly reliable fiducial markers under occlusion" (2014),
as OpenCV has it. A marker is found whole or not at all; sides of 24 pixels and more are what to design for (see
`surveillance_domain.vision.marker_size`).
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, UInt8

from surveillance_domain.site.sections import Markers
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.opencv import opencv

__all__ = ["MARKER", "MarkerDetector"]

MARKER = "marker"
"""The kind of these detections."""

_LEAST_SIDE_PX = 8.0
_SAMPLES = 12
"""Across a square of the pattern, when it is read: with OpenCV's own 4 small flat markers are misread now and then."""


class MarkerDetector:
    """Finds the markers of a site; identities are their numbers.

    Parameters
    ----------
    markers : Markers
        Dictionary, and how high above the floor they lie, level.
    """

    def __init__(self, markers: Markers) -> None:
        cv2 = opencv()
        self._height_m = float(markers.height_m)
        self._dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{markers.dictionary}"))

    def detect(self, picture: UInt8[np.ndarray, "height width 3"]) -> tuple[Detection, ...]:
        aruco = opencv().aruco
        settings = aruco.DetectorParameters()
        settings.minMarkerPerimeterRate = 4 * _LEAST_SIDE_PX / max(picture.shape[:2])
        settings.cornerRefinementMethod = aruco.CORNER_REFINE_SUBPIX
        settings.perspectiveRemovePixelPerCell = _SAMPLES
        found = aruco.ArucoDetector(self._dictionary, settings).detectMarkersWithConfidence(picture)
        corners, numbers, confidences, _ = found
        if numbers is None:
            return ()
        seen = zip(corners, np.ravel(numbers).tolist(), np.ravel(confidences).tolist(), strict=True)
        return tuple(self._detection(np.asarray(four[0], dtype=float), *rest) for four, *rest in seen)

    def _detection(self, corners: Float[np.ndarray, "4 2"], number: int, confidence: float) -> Detection:
        side_px = float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).mean())
        u, v = _crossing(corners)
        return Detection((u, v), self._height_m, MARKER, number, float(np.clip(confidence, 0, 1)), side_px)


def _crossing(corners: Float[np.ndarray, "4 2"]) -> tuple[float, float]:
    """Where the diagonals cross: the image of the square's centre, which the corners' mean is not."""
    start, along = corners[0], corners[2] - corners[0]
    other, across = corners[1], corners[3] - corners[1]
    share, _ = np.linalg.solve(np.column_stack([along, -across]), other - start)
    u, v = start + share * along
    return float(u), float(v)
