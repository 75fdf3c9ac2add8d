"""What stands on the floor of an emulated site, as flat faces: walls, and targets as boxes with coloured tops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.grid import Grid

__all__ = ["Face", "box", "level_square", "walls"]

Colour = tuple[int, int, int]

_SHADES = (0.8, 0.95, 0.75, 0.6)
_SIDES = ((0, -1), (1, 0), (0, 1), (-1, 0))


@dataclass(frozen=True, eq=False)
class Face:
    """A flat convex polygon, seen from the side from which its corners run counter-clockwise.

    Attributes
    ----------
    corners_m : (corners, 3) float
    colour : (int, int, int)
        Red, green, blue.
    texture : (rows, columns, 3) uint8 or None
        In place of the colour, over a face of four corners: lower left, lower right, upper right, upper left.
    """

    corners_m: Float[np.ndarray, "corners 3"]
    colour: Colour
    texture: np.ndarray | None = None


def walls(grid: Grid, height_m: float, colour: Colour) -> tuple[Face, ...]:
    """Faces of the blocked cells towards free ones and the outside, joined to runs; and their tops."""
    free = np.pad(grid.free, 1, constant_values=True)
    faces: list[Face] = []
    for side, ((dx, dy), shade) in enumerate(zip(_SIDES, _SHADES, strict=True)):
        neighbour = free[1 + dy : 1 + dy + grid.rows, 1 + dx : 1 + dx + grid.columns]
        for run in _runs(grid, ~grid.free & neighbour, along_rows=dy != 0):
            faces.append(_side(run, side, height_m, _shaded(colour, shade)))
    for run in _runs(grid, ~grid.free, along_rows=True):
        faces.append(Face(_at(run, height_m), colour))
    return tuple(faces)


def _runs(grid: Grid, mask: np.ndarray, along_rows: bool) -> list[Float[np.ndarray, "4 2"]]:
    """Corners on the floor, counter-clockwise from the lower left, of the rectangles that rows of cells make."""
    lines = mask if along_rows else mask.T
    edges = np.diff(np.pad(lines.astype(np.int8), ((0, 0), (1, 1))), axis=1)
    found = []
    for (line, first), (_, end) in zip(np.argwhere(edges == 1), np.argwhere(edges == -1), strict=True):
        low, high = np.array([first, line]), np.array([end, line + 1])
        (left, bottom), (right, top) = (low, high) if along_rows else (low[::-1], high[::-1])
        cells = np.array([(left, bottom), (right, bottom), (right, top), (left, top)])
        found.append(cells * grid.cell_m + np.asarray(grid.origin_m))
    return found


def _side(ground_m: Float[np.ndarray, "4 2"], side: int, height_m: float, colour: Colour) -> Face:
    """One of the four sides of a box: below, right, above, left of its ground, in that order."""
    ends = ground_m[[side, (side + 1) % 4]]
    return Face(np.vstack([_at(ends, 0.0), _at(ends[::-1], height_m)]), colour)


def _at(points_m: Float[np.ndarray, "points 2"], height_m: float) -> Float[np.ndarray, "points 3"]:
    return np.column_stack([points_m, np.full(len(points_m), height_m)])


def box(
    place_m: Float[np.ndarray, "2"],
    heading_rad: float,
    side_m: float,
    height_m: float,
    colour: Colour,
    texture: np.ndarray | None,
) -> tuple[Face, ...]:
    """A square box on the floor, turned by its heading; its top may bear a texture."""
    corners = _square(side_m)
    cosine, sine = np.cos(heading_rad), np.sin(heading_rad)
    ground = corners @ np.array([[cosine, sine], [-sine, cosine]]) + place_m
    sides = [_side(ground, side, height_m, _shaded(colour, 0.8 * shade)) for side, shade in enumerate(_SHADES)]
    return (Face(_at(ground, height_m), colour, texture), *sides)


def level_square(
    place_m: Float[np.ndarray, "2"], side_m: float, height_m: float, colour: Colour, texture: np.ndarray
) -> Face:
    """A square that lies level, its sides along the axes of the map; it may bear a texture."""
    return Face(_at(_square(side_m) + place_m, height_m), colour, texture)


def _square(side_m: float) -> Float[np.ndarray, "4 2"]:
    half = side_m / 2
    return np.array([(-half, -half), (half, -half), (half, half), (-half, half)])


def _shaded(colour: Colour, shade: float) -> Colour:
    red, green, blue = (round(shade * part) for part in colour)
    return red, green, blue
