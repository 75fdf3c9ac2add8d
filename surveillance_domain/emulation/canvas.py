"""Painting flat faces through a pinhole, with a depth for every pixel, so that the nearer hides the farther.

On a plane 1 / depth is an affine function of the pixel, so depths are exact. Edges are smoothed by painting each face
several times finer than the picture. OpenCV does the painting; colours are in its order: blue, green, red.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from surveillance_domain.emulation.solids import Face
from surveillance_domain.model.pinhole import Pinhole

__all__ = ["Canvas"]

_NEAREST_M = 0.02
_FINER = 3
_MOST_FINE_PIXELS = 400_000
_SAME_DEPTH = 1e-6


class Canvas:
    """A picture in the making.

    Parameters
    ----------
    pinhole : Pinhole
    picture : (height, width, 3) uint8
        What is there before; painted over.
    inverse_depth : (height, width) float
        1 / distance along the optical axis of what is there, 1 / metres; 0 is infinitely far.
    """

    def __init__(self, pinhole: Pinhole, picture: np.ndarray, inverse_depth: Float[np.ndarray, "height width"]) -> None:
        self.picture, self._inverse_depth, self._pinhole = picture, inverse_depth, pinhole

    def paint(self, face: Face) -> None:
        """Put a face where nothing nearer is."""
        import cv2

        plane = self._facing(face)
        corners = _in_front(self._pinhole, face.corners_m)
        if plane is None or len(corners) < 3:
            return
        pixels = self._pinhole.project(corners)
        window = self._window(pixels)
        if window is None:
            return
        left, top, right, bottom = window
        finer = _FINER if (right - left) * (bottom - top) * _FINER**2 <= _MOST_FINE_PIXELS else 1
        size = ((right - left) * finer, (bottom - top) * finer)
        shift = np.array([[finer, 0, (0.5 - left) * finer - 0.5], [0, finer, (0.5 - top) * finer - 0.5], [0, 0, 1]])
        fine = pixels * finer + shift[:2, 2]
        cover = np.zeros(size[::-1], dtype=np.uint8)
        cv2.fillConvexPoly(cover, np.rint(fine * 16).astype(np.int32), 255, lineType=cv2.LINE_8, shift=4)
        paint: np.ndarray
        if face.texture is None:
            paint = np.full((bottom - top, right - left, 3), face.colour[::-1], dtype=np.uint8)
        else:
            paint = self._textured(face, shift, size)
            paint = cv2.resize(paint, (right - left, bottom - top), interpolation=cv2.INTER_AREA)
        share = cv2.resize(cover, (right - left, bottom - top), interpolation=cv2.INTER_AREA).astype(np.float32) / 255
        u, v = np.arange(left, right), np.arange(top, bottom)
        depth = plane[0] * u[None, :] + plane[1] * v[:, None] + plane[2]
        behind = self._inverse_depth[top:bottom, left:right]
        share[depth < behind - _SAME_DEPTH] = 0.0
        patch = self.picture[top:bottom, left:right]
        patch += np.rint((paint.astype(np.float32) - patch) * share[..., None]).astype(np.int16).astype(np.uint8)
        behind[share >= 0.5] = depth[share >= 0.5]

    def _facing(self, face: Face) -> Float[np.ndarray, "3"] | None:
        """1 / depth of the face's plane as ``a u + b v + c``; ``None`` if it is seen from behind or edge on."""
        a, b, c = face.corners_m[:3]
        normal = np.cross(b - a, c - a)
        away = float(normal @ (a - self._pinhole.position_m))
        if away >= 0:
            return None
        at = self._pinhole.rays(np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])) @ normal / away
        return np.array([at[1] - at[0], at[2] - at[0], at[0]])

    def _window(self, pixels: Float[np.ndarray, "corners 2"]) -> tuple[int, int, int, int] | None:
        """Left, top, right and bottom of the part of the picture in which the face lies; ``None`` if outside."""
        low, high = np.floor(pixels.min(axis=0) - 0.5), np.ceil(pixels.max(axis=0) + 1.5)
        height, width = self._inverse_depth.shape
        left, top = (int(part) for part in np.clip(low, 0, (width, height)))
        right, bottom = (int(part) for part in np.clip(high, 0, (width, height)))
        return (left, top, right, bottom) if right > left and bottom > top else None

    def _textured(self, face: Face, shift: Float[np.ndarray, "3 3"], size: tuple[int, int]) -> np.ndarray:
        """The face's texture as the camera sees it, in the fine window."""
        import cv2

        texture = face.texture
        if texture is None:
            raise ValueError("a face without texture")
        rows, columns = texture.shape[:2]
        origin, right, _, up = face.corners_m
        # from texture pixels to places on the face: column 0 begins at the left edge, row 0 at the upper one
        flat = np.column_stack(
            [(right - origin) / columns, -(up - origin) / rows, up + (right - origin) / (2 * columns)]
        )
        flat[:, 2] -= (up - origin) / (2 * rows)
        to_picture = self._pinhole.projection @ np.vstack([flat, [0.0, 0.0, 1.0]])
        return cv2.warpPerspective(
            texture, shift @ to_picture, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
        )


def _in_front(pinhole: Pinhole, corners_m: Float[np.ndarray, "corners 3"]) -> Float[np.ndarray, "left 3"]:
    """The part of a polygon that lies in front of the camera."""
    forward = (corners_m - pinhole.position_m) @ pinhole.axes[:, 0] - _NEAREST_M
    if (forward >= 0).all():
        return corners_m
    kept = []
    for number in range(len(corners_m)):
        here, after = number, (number + 1) % len(corners_m)
        if forward[here] >= 0:
            kept.append(corners_m[here])
        if forward[here] * forward[after] < 0:
            share = forward[here] / (forward[here] - forward[after])
            kept.append(corners_m[here] + share * (corners_m[after] - corners_m[here]))
    return np.array(kept).reshape(-1, 3)
