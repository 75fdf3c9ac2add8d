"""Surfaces of an emulated site: a floor of speckled tiles, and the tops of targets with their markers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from surveillance_domain.site.grid import Grid

__all__ = ["Floor", "MARKER_SHARE", "floor", "marker_top", "modules"]

MARKER_SHARE = 0.6
"""Side of a marker as a share of the top that bears it."""

_MOST_PIXELS = 2048
_MARGIN_M = 2.0
_TILE_M = 0.5
_PIXELS_PER_MODULE = 16
_SPECKLE = 512


@dataclass(frozen=True, eq=False)
class Floor:
    """A picture of the floor from above.

    Attributes
    ----------
    texture : (rows, columns, 3) uint8
        Blue, green, red; row 0 is the uppermost.
    corner_m : (float, float)
        x and y of its lower-left corner, in metres.
    px_per_m : float
    """

    texture: np.ndarray
    corner_m: tuple[float, float]
    px_per_m: float


def floor(grid: Grid, rng: np.random.Generator) -> Floor:
    """Grey tiles of half a metre with dark joints, speckled, on the map and two metres around it."""
    import cv2

    size_m = np.array([grid.columns, grid.rows]) * grid.cell_m + 2 * _MARGIN_M
    px_per_m = float(min(200.0, _MOST_PIXELS / size_m.max()))
    columns, rows = (int(side) for side in np.ceil(size_m * px_per_m))
    corner = (grid.origin_m[0] - _MARGIN_M, grid.origin_m[1] - _MARGIN_M)
    coarse = cv2.resize(rng.normal(0, 5, (rows // 16 + 1, columns // 16 + 1)), (columns, rows))
    speckle = rng.normal(0, 6, (_SPECKLE, _SPECKLE))
    shade = 150 + coarse + np.tile(speckle, (rows // _SPECKLE + 1, columns // _SPECKLE + 1))[:rows, :columns]
    x = corner[0] + (np.arange(columns) + 0.5) / px_per_m
    y = corner[1] + (rows - np.arange(rows) - 0.5) / px_per_m
    joint_m = max(0.012, 0.8 / px_per_m)
    shade[:, np.mod(x, _TILE_M) < joint_m] -= 25
    shade[np.mod(y, _TILE_M) < joint_m, :] -= 25
    outside = (x < grid.origin_m[0]) | (x > grid.origin_m[0] + grid.columns * grid.cell_m)
    shade[:, outside] *= 0.7
    outside = (y < grid.origin_m[1]) | (y > grid.origin_m[1] + grid.rows * grid.cell_m)
    shade[outside, :] *= 0.7
    texture = np.clip(shade[..., None] * np.array([0.94, 0.98, 1.0]), 0, 255).astype(np.uint8)
    return Floor(texture, corner, px_per_m)


def modules(dictionary: str) -> int:
    """How many squares of black and white a marker has along a side, its border included."""
    return (5 if dictionary == "ARUCO_ORIGINAL" else int(dictionary[0])) + 2


def marker_top(dictionary: str, number: int, colour: tuple[int, int, int]) -> np.ndarray:
    """A coloured square with the marker in its middle and a white rim of one module around that; upright at ``row 0``.

    Returns
    -------
    (rows, columns, 3) uint8
        Blue, green, red.

    Raises
    ------
    ValueError
        For a number that the dictionary does not have.
    """
    import cv2

    squares = modules(dictionary)
    side = squares * _PIXELS_PER_MODULE
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
    if not 0 <= number < len(known.bytesList):
        raise ValueError(f"marker {number}: the dictionary {dictionary} has 0 to {len(known.bytesList) - 1}")
    marker = cv2.aruco.generateImageMarker(known, number, side)
    whole = round(side / MARKER_SHARE)
    top = np.full((whole, whole, 3), colour[::-1], dtype=np.uint8)
    rim, start = _PIXELS_PER_MODULE, (whole - side) // 2
    top[start - rim : start + side + rim, start - rim : start + side + rim] = 255
    top[start : start + side, start : start + side] = marker[..., None]
    return top
