"""Coloured blobs: targets told apart by the hue of what they wear, where they carry no markers."""

from __future__ import annotations

import colorsys
from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import UInt8

from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.opencv import opencv

__all__ = ["BLOB", "BlobDetector", "Colour"]

BLOB = "blob"
"""The kind of these detections."""

Colour = tuple[int, int, int]
"""Red, green and blue, 0 to 255."""

_HUES = 180
_NEAR_HUE = 9
_LEAST_SATURATION, _LEAST_VALUE = 90, 45
_PALE = 0.4
_LEAST_PIXELS = 60
_CONFIDENCE_AT_EDGE = 0.5


class BlobDetector:
    """Finds patches of the targets' hues, in HSV; identities are the targets' names.

    A blob stands for the middle of its body: the outline of a body that is the same on both sides of its centre, as
    boxes and people roughly are, is centred on the picture of that centre, at half the body's height. Blobs that the
    picture's edge cuts are not, and have confidence 0.5. A hue that several targets have gives no identity.

    Parameters
    ----------
    colours : mapping of str to (int, int, int)
        For each target its red, green and blue, 0 to 255.
    body_height_m : float
        How high the coloured bodies are, from the floor up, in metres.

    Attributes
    ----------
    left_out : tuple of str
        Targets whose colour is too pale, or too dark, to have a hue; they are not looked for.
    """

    def __init__(self, colours: Mapping[str, Colour], body_height_m: float) -> None:
        hues = {name: _hue(colour) for name, colour in colours.items()}
        self.left_out = tuple(name for name, hue in hues.items() if hue is None)
        self._height_m = body_height_m / 2
        self._hues = {name: hue for name, hue in hues.items() if hue is not None}

    def detect(self, picture: UInt8[np.ndarray, "height width 3"]) -> tuple[Detection, ...]:
        cv2 = opencv()
        hue, saturation, value = cv2.split(cv2.cvtColor(picture, cv2.COLOR_BGR2HSV))
        coloured = (saturation >= _LEAST_SATURATION) & (value >= _LEAST_VALUE)
        found: list[Detection] = []
        for middle, names in self._groups():
            away = np.abs(hue.astype(np.int16) - middle)
            mask = (np.minimum(away, _HUES - away) <= _NEAR_HUE) & coloured
            found += self._blobs(mask.astype(np.uint8), names[0] if len(names) == 1 else None)
        return tuple(found)

    def _groups(self) -> list[tuple[int, list[str]]]:
        """Hues, and the targets that a patch of that hue may be."""
        groups: list[tuple[int, list[str]]] = []
        for name, hue in self._hues.items():
            near = [names for middle, names in groups if _apart(hue, middle) <= 2 * _NEAR_HUE]
            if near:
                near[0].append(name)
            else:
                groups.append((hue, [name]))
        return groups

    def _blobs(self, mask: Any, identity: str | None) -> list[Detection]:
        cv2 = opencv()
        height, width = mask.shape
        mask = cv2.morphologyEx(mask, cv2.MORPH_OPEN, np.ones((3, 3), dtype=np.uint8))
        outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        found = []
        for outline in outlines:
            moments = cv2.moments(cv2.convexHull(outline))
            if moments["m00"] < _LEAST_PIXELS:
                continue
            u, v = moments["m10"] / moments["m00"], moments["m01"] / moments["m00"]
            left, top, across, along = cv2.boundingRect(outline)
            cut = left <= 1 or top <= 1 or left + across >= width - 1 or top + along >= height - 1
            confidence = _CONFIDENCE_AT_EDGE if cut else 1.0
            found.append(Detection((u, v), self._height_m, BLOB, identity, confidence, float(moments["m00"] ** 0.5)))
        return found


def _hue(colour: Colour) -> int | None:
    """As OpenCV counts it, 0 to 179; ``None`` where a colour has none to speak of."""
    red, green, blue = (part / 255 for part in colour)
    hue, saturation, value = colorsys.rgb_to_hsv(red, green, blue)
    if saturation < _PALE or value * 255 < 2 * _LEAST_VALUE:
        return None
    return round(hue * _HUES) % _HUES


def _apart(one: int, other: int) -> int:
    return min((one - other) % _HUES, (other - one) % _HUES)
