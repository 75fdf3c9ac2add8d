"""Maps in the form of ROS map_server: a yaml file beside a PGM or PNG picture.

Pixels are read as map_server reads them. The lightness of a pixel is the mean of its channels (in trinary mode the
alpha channel counts as one of them, in the other modes it does not); the occupancy is ``p = (255 - lightness) / 255``,
or ``p = lightness / 255`` with ``negate``. Then

- ``trinary``: ``p > occupied_thresh`` occupied, ``p < free_thresh`` free, otherwise unknown;
- ``scale``: the same where the picture is opaque, unknown where it is not. What map_server publishes as a value
  between 1 and 99 is neither occupied nor free for planning, so it counts as unknown;
- ``raw``: the lightness itself is the published value, 0 to 100 (above: unknown), and is compared with the thresholds
  in percent: ``value >= 100 occupied_thresh`` occupied, ``value <= 100 free_thresh`` free.

Row 0 of the picture is its top; ``origin`` is the lower-left corner of its lower-left pixel.
Source: https://wiki.ros.org/map_server (map format, value interpretation).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Bool, Int

from surveillance_domain.site.faults import Fault
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.ros_header import RosMapError, read_ros_header
from surveillance_domain.site.ros_picture import read_ros_picture

__all__ = ["RosMap", "RosMapError", "read_ros_map"]

_MOST_CELLS = 20_000_000
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class RosMap:
    """What map_server would publish, for planning.

    Attributes
    ----------
    occupied, free : (rows, columns) bool
        Pixels, row 0 the lowest; a pixel that is neither is unknown.
    resolution_m : float
        Side of a pixel in metres.
    origin_m : (float, float)
        Lower-left corner in metres.
    contents : tuple of bytes
        The yaml file and the picture, for digests.
    """

    occupied: Bool[np.ndarray, "rows columns"]
    free: Bool[np.ndarray, "rows columns"]
    resolution_m: float
    origin_m: tuple[float, float]
    contents: tuple[bytes, ...] = ()

    def grid(self, cell_m: float, unknown: Literal["blocked", "free"] = "blocked") -> Grid:
        """Resample to a planning grid.

        A pixel lies in the cell that holds its centre. A cell is blocked if any pixel in it is occupied, free if none
        is and at least half are free, and what ``unknown`` says otherwise. A cell that no pixel's centre falls into
        (cells smaller than pixels) is judged by the pixel under its own centre.

        Raises
        ------
        RosMapError
            If the grid would have more than 20 million cells.
        """
        rows, columns = (_round_up(count * self.resolution_m / cell_m) for count in self.occupied.shape)
        if rows * columns > _MOST_CELLS:
            found = f"{cell_m:g}, which makes {rows * columns} cells"
            raise RosMapError("map", (Fault("cell_m", found, f"cells so large that at most {_MOST_CELLS} are needed"),))
        row = _cell_of_pixel(self.occupied.shape[0], rows, self.resolution_m / cell_m)
        column = _cell_of_pixel(self.occupied.shape[1], columns, self.resolution_m / cell_m)
        pixels = np.outer(np.bincount(row, minlength=rows), np.bincount(column, minlength=columns))
        occupied, free = (_sums(marked, row, column, pixels.shape) for marked in (self.occupied, self.free))
        if np.any(pixels == 0):
            scale = cell_m / self.resolution_m
            under = np.ix_(
                _cell_of_pixel(rows, self.occupied.shape[0], scale),
                _cell_of_pixel(columns, self.occupied.shape[1], scale),
            )
            occupied = np.where(pixels == 0, self.occupied[under], occupied)
            free = np.where(pixels == 0, self.free[under], free)
            pixels = np.maximum(pixels, 1)
        return Grid((occupied == 0) & ((2 * free >= pixels) | (unknown == "free")), cell_m, self.origin_m)


def _round_up(value: float) -> int:
    """The next whole number, at least 1; a rounding error above a whole number is forgiven."""
    return max(1, int(np.ceil(value - _ROUNDING)))


def _cell_of_pixel(pixels: int, cells: int, cells_per_pixel: float) -> Int[np.ndarray, " pixels"]:
    """Along one axis: the cell that holds each pixel's centre."""
    cell = np.floor((np.arange(pixels) + 0.5) * cells_per_pixel + _ROUNDING).astype(np.int64)
    return np.clip(cell, 0, cells - 1)


def _sums(
    marked: Bool[np.ndarray, "_ _"], row: Int[np.ndarray, "_"], column: Int[np.ndarray, "_"], shape: tuple[int, int]
) -> Int[np.ndarray, "rows columns"]:
    """How many pixels of each cell are marked."""
    cell = row[:, None] * shape[1] + column[None, :]
    return np.bincount(cell[marked], minlength=shape[0] * shape[1]).reshape(shape)


def read_ros_map(path: Path) -> RosMap:
    """Read a map_server yaml file and its picture.

    Raises
    ------
    RosMapError
        With every fault of the yaml file, or that of the picture.
    """
    header, text = read_ros_header(path)
    lightness, opaque, content = read_ros_picture(path.parent / header.image, alpha_counts=header.mode == "trinary")
    lightness = 255 - lightness if header.negate else lightness
    if header.mode == "raw":
        value = np.floor(lightness)
        occupied = (value <= 100) & (value >= 100 * header.occupied_thresh)
        free = ~occupied & (value <= 100 * header.free_thresh)
    else:
        occupancy = (255 - lightness) / 255
        known = opaque | (header.mode == "trinary")
        occupied = known & (occupancy > header.occupied_thresh)
        free = known & ~occupied & (occupancy < header.free_thresh)
    origin = (header.origin[0], header.origin[1])
    return RosMap(occupied[::-1], free[::-1], header.resolution, origin, (text, content))
