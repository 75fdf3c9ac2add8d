"""The floor's grid drawn over a picture, so that a person sees whether a calibration fits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float, UInt8

from surveillance_domain.site.grid import Grid
from surveillance_domain.vision.ground import Ground
from surveillance_domain.vision.opencv import opencv
from surveillance_domain.vision.points import PointResidual

__all__ = ["draw_grid"]

_LINE, _EDGE, _WALL, _LABEL = (255, 220, 0), (0, 200, 255), (60, 60, 220), (255, 255, 255)
_GOOD, _BAD, _SHADOW = (80, 220, 80), (60, 60, 255), (30, 30, 30)
_PIECES = 12
_LEAST_LABELLED_PX = 44.0
_FARTHEST_PX = 20_000.0


def draw_grid(
    picture: UInt8[np.ndarray, "height width 3"], ground: Ground, grid: Grid, points: Sequence[PointResidual] = ()
) -> UInt8[np.ndarray, "height width 3"]:
    """A copy of a picture with the cells' edges, the map's outline, column and row in cells that are large enough.

    A point of the calibration is a cross where it was seen and a circle where it should be; red: it does not fit.
    """
    cv2 = opencv()
    drawn = picture.copy()
    for line, colour, width in _lines(grid):
        pieces = [np.rint(piece * 16).astype(np.int32) for piece in _pieces(ground, line)]
        for ink, thickness in ((_SHADOW, width + 2), (colour, width)):
            cv2.polylines(drawn, pieces, False, ink, thickness, cv2.LINE_AA, 4)
    for text, pixel in _labels(ground, grid, (picture.shape[1], picture.shape[0])):
        _write(drawn, text, pixel, _LABEL)
    for one in points:
        colour = _GOOD if one.fits else _BAD
        u, v = (round(part) for part in one.point.pixel)
        cv2.drawMarker(drawn, (u, v), colour, cv2.MARKER_TILTED_CROSS, 14, 2, cv2.LINE_AA)
        height = np.array([one.point.height_m])
        (expected,) = ground.in_picture(np.array([one.point.place_m]), height)
        if np.isfinite(expected).all() and np.abs(expected).max() < _FARTHEST_PX:
            centre = (round(float(expected[0])), round(float(expected[1])))
            cv2.circle(drawn, centre, 9, colour, 2, cv2.LINE_AA)
            cv2.line(drawn, (u, v), centre, colour, 1, cv2.LINE_AA)
        if not one.fits:
            _write(drawn, one.point.name, (u + 12, v), _BAD)
    return drawn


def _lines(grid: Grid) -> Iterator[tuple[Float[np.ndarray, "2 2"], tuple[int, int, int], int]]:
    """Ends of every line of the grid in metres, its colour, its width in pixels."""
    low = np.asarray(grid.origin_m)
    for column in range(grid.columns + 1):
        edge = column in (0, grid.columns)
        ends = np.array([[column, 0], [column, grid.rows]]) * grid.cell_m + low
        yield ends, _EDGE if edge else _LINE, 2 if edge else 1
    for row in range(grid.rows + 1):
        edge = row in (0, grid.rows)
        ends = np.array([[0, row], [grid.columns, row]]) * grid.cell_m + low
        yield ends, _EDGE if edge else _LINE, 2 if edge else 1
    for row, column in np.argwhere(~grid.free):
        cell = np.array([column, row])
        for ends in ([[0, 0], [1, 1]], [[0, 1], [1, 0]]):
            yield (cell + np.array(ends)) * grid.cell_m + low, _WALL, 1


def _pieces(ground: Ground, line: Float[np.ndarray, "2 2"]) -> Iterator[Float[np.ndarray, "2 2"]]:
    """The parts of a line on the floor that the camera sees, in pixels; short, for a part of it may lie behind."""
    share = np.linspace(0, 1, _PIECES + 1)[:, None]
    pixels = ground.in_picture(line[0] + share * (line[1] - line[0]), np.zeros(_PIECES + 1))
    usable = np.isfinite(pixels).all(axis=1) & (np.abs(pixels) < _FARTHEST_PX).all(axis=1)
    for number in range(_PIECES):
        if usable[number] and usable[number + 1]:
            yield pixels[number : number + 2]


def _labels(ground: Ground, grid: Grid, size: tuple[int, int]) -> Iterator[tuple[str, tuple[int, int]]]:
    """Column and row of free cells in the picture that have room for it."""
    centres = grid.centres_m
    pixels = ground.in_picture(centres, np.zeros(len(centres)))
    corner = ground.in_picture(centres + grid.cell_m / 2, np.zeros(len(centres)))
    room = np.sqrt(2) * np.linalg.norm(corner - pixels, axis=1)
    inside = ((pixels >= 0) & (pixels < size)).all(axis=1)
    for number in np.flatnonzero(inside & (room >= _LEAST_LABELLED_PX)):
        column, row = grid.cells[number].tolist()
        u, v = pixels[number]
        yield f"{column},{row}", (round(float(u)) - 12, round(float(v)) + 4)


def _write(drawn: UInt8[np.ndarray, "height width 3"], text: str, pixel: tuple[int, int], ink: tuple[int, ...]) -> None:
    cv2 = opencv()
    for colour, thickness in ((_SHADOW, 3), (ink, 1)):
        cv2.putText(drawn, text, pixel, cv2.FONT_HERSHEY_SIMPLEX, 0.45, colour, thickness, cv2.LINE_AA)
