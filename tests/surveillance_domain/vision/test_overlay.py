"""The grid over a picture is where the cells are."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.cameras.base import Position
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.overlay import draw_grid
from surveillance_domain.vision.points import FloorPoint, judged, residuals
from tests.known_points import points_of

LEGO = load_site("lego")
SOUTH = LEGO.cameras[0]
HERE = ground(SOUTH, Position(0.0, -40.0, 1.0), (704, 576))
GREY = np.full((576, 704, 3), 110, dtype=np.uint8)


def changed(drawn: np.ndarray, place_m: tuple[float, float]) -> bool:
    ((u, v),) = HERE.in_picture(np.array([place_m]), np.zeros(1))
    return bool((drawn[round(v) - 1 : round(v) + 2, round(u) - 1 : round(u) + 2] != 110).any())


@pytest.mark.example
def test_lines_lie_on_the_edges_of_cells() -> None:
    drawn = draw_grid(GREY, HERE, LEGO.grid)
    assert changed(drawn, (1.2, 1.05))  # on x = 4 cells
    assert changed(drawn, (1.35, 1.2))  # on y = 4 cells
    assert not changed(drawn, (1.25, 1.35 + 0.1))  # inside of a cell, beside its label
    assert (GREY == 110).all()  # the picture given is left alone


@pytest.mark.example
def test_points_that_do_not_fit_are_red() -> None:
    points = points_of(SOUTH, "middle")
    points.append(FloorPoint("wrong", "middle", (300.0, 300.0), (1.0, 1.0)))
    found = judged(residuals(points, {"middle": HERE}), np.array([True] * 6 + [False]))
    drawn = draw_grid(GREY, HERE, LEGO.grid, found)
    assert tuple(drawn[300, 300]) == (60, 60, 255)
    u, v = (round(part) for part in points[0].pixel)
    assert tuple(drawn[v, u]) == (80, 220, 80)


@pytest.mark.example
def test_a_camera_that_sees_no_floor_draws_nothing() -> None:
    up = ground(SOUTH, Position(0.0, 30.0, 1.0), (704, 576))
    np.testing.assert_array_equal(draw_grid(GREY, up, LEGO.grid), GREY)
