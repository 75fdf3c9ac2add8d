"""From located detections to the model's observations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surveillance_domain.model.views import Views
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.ground import Ground
from surveillance_domain.vision.observe import Cell, Located, Observer, cell_of, located

GRID = Grid.from_rows(["....", "..#.", "...."], 0.5, (1.0, 0.0))
EVERYWHERE = np.ones((1, GRID.size))
VIEWS = {"west": "only", "east": "only"}


def detection(identity: int | str | None, confidence: float = 1.0) -> Detection:
    return Detection((0.0, 0.0), 0.0, "marker", identity, confidence, 30.0)


def at(cell: Cell | None, identity: int | str | None = 7, confidence: float = 1.0) -> Located:
    return Located(detection(identity, confidence), (0.0, 0.0), cell)


def observer(
    noise_m: tuple[float, float] = (0.0, 0.0), west: np.ndarray = EVERYWHERE, east: np.ndarray = EVERYWHERE
) -> Observer:
    """Two cameras, west and east; marker 7 is red, marker 8 is blue, and red is told by its colour too."""
    micro = load_site("micro")
    cameras = tuple(
        one.model_copy(update={"name": name, "presets": (one.presets[0].model_copy(update={"name": "only"}),)})
        for one, name in zip(micro.cameras, ("west", "east"), strict=True)
    )
    site = replace(micro, grid=GRID, cameras=cameras)
    views = Views((west, east), noise_m)
    return Observer(site, views, ("red", "blue"), {7: "red", 8: "blue", "red": "red", 9: "somebody"})


@pytest.mark.example
def test_each_target_has_its_cell_or_none() -> None:
    seen = observer().observe({"west": [at((0, 1))], "east": []}, VIEWS)
    assert seen.observations == {"red": (0, 1), "blue": None}
    assert (seen.unknown, seen.without_identity, seen.out_of_view) == ({}, 0, 0)


@pytest.mark.example
def test_the_camera_with_the_least_noise_reports() -> None:
    found = {"west": [at((0, 0))], "east": [at((1, 0))]}
    assert observer((0.3, 0.1)).observe(found, VIEWS).observations["red"] == (1, 0)
    assert observer((0.1, 0.3)).observe(found, VIEWS).observations["red"] == (0, 0)
    assert observer((0.1, 0.1)).observe(found, VIEWS).observations["red"] == (0, 0)  # of equals the first


@pytest.mark.example
def test_of_two_detections_of_a_camera_the_surer_one_counts() -> None:
    found = {"west": [at((0, 0), 7, 0.5), at((1, 0), "red", 0.9)]}
    assert observer().observe(found, VIEWS).observations["red"] == (1, 0)


@pytest.mark.example
def test_what_belongs_to_no_target_is_told_apart() -> None:
    found = {"west": [at((0, 0), 33), at((1, 0), None), at((2, 0), None), at((3, 0), 9)], "east": [at((1, 1), 33)]}
    seen = observer().observe(found, VIEWS)
    assert seen.observations == {"red": None, "blue": None}
    assert seen.unknown == {33: (0, 0), 9: (3, 0)}  # 9 is known at the site, but nobody asks for it here
    assert seen.without_identity == 2


@pytest.mark.example
def test_cameras_without_a_view_are_not_listened_to() -> None:
    found = {"west": [at((0, 0))], "east": [at((1, 0), 8)]}
    seen = observer().observe(found, {"west": None})
    assert seen.observations == {"red": None, "blue": None}
    assert seen.out_of_view == 0


LEFT = (GRID.cells[:, 0] == 0).astype(float)[None, :]
"""West sees the leftmost column."""


@pytest.mark.example
def test_what_a_picture_shows_beyond_the_view_is_reported_and_told_apart() -> None:
    found = {"west": [at((1, 0), 7), at((3, 0), 8), at((0, 0), 33), at((1, 1), 34)]}
    sharp = observer((0.0, 0.0), LEFT).observe(found, VIEWS)
    assert sharp.observations == {"red": (1, 0), "blue": (3, 0)}
    assert sharp.unknown == {33: (0, 0), 34: (1, 1)}
    assert sharp.beyond == {"red": "west", "blue": "west", 34: "west"}
    assert sharp.out_of_view == 0
    # With noise of 0.25 m a report may be 0.75 m off: a cell further, but not three.
    blurred = observer((0.25, 0.25), LEFT).observe(found, VIEWS)
    assert blurred.observations == sharp.observations
    assert blurred.beyond == {"blue": "west"}


@pytest.mark.example
def test_a_report_in_view_goes_before_one_beyond_whoever_gives_it() -> None:
    found = {"west": [at((1, 0), 7, 1.0), at((0, 0), "red", 0.5)], "east": [at((2, 0), 8)]}
    seen = observer((0.0, 0.1), LEFT).observe(found, VIEWS)
    assert seen.observations == {"red": (0, 0), "blue": (2, 0)}  # west's less sure one, but of its own view
    assert seen.beyond == {}
    other = {"west": [at((1, 0))], "east": [at((3, 0))]}
    assert observer((0.0, 0.1), LEFT).observe(other, VIEWS).observations["red"] == (3, 0)  # though east has more noise
    both = {"west": [at((1, 0), 33)], "east": [at((3, 0), 33)]}
    seen = observer((0.0, 0.1), LEFT).observe(both, VIEWS)
    assert (seen.unknown, seen.beyond) == ({33: (3, 0)}, {})


@pytest.mark.example
def test_beyond_their_views_the_camera_with_the_least_noise_reports() -> None:
    blind = np.zeros((1, GRID.size))
    found = {"west": [at((0, 0))], "east": [at((1, 0))]}
    for noise_m, cell, camera in (
        ((0.3, 0.1), (1, 0), "east"),
        ((0.1, 0.3), (0, 0), "west"),
        ((0.0, 0.0), (0, 0), "west"),
    ):
        seen = observer(noise_m, blind, blind).observe(found, VIEWS)
        assert (seen.observations["red"], seen.beyond) == (cell, {"red": camera})


@pytest.mark.example
def test_what_lies_on_no_free_cell_is_counted_and_not_used() -> None:
    seen = observer().observe({"west": [at(None, "red"), at(None, 33)]}, VIEWS)
    assert seen.observations == {"red": None, "blue": None}
    assert (seen.unknown, seen.beyond, seen.out_of_view) == ({}, {}, 2)


@pytest.mark.example
def test_cells_by_hand() -> None:
    assert cell_of(GRID, np.array([1.1, 0.1])) == (0, 0)
    assert cell_of(GRID, np.array([2.9, 1.4])) == (3, 2)
    assert cell_of(GRID, np.array([2.1, 0.75])) == (1, 1)  # in the wall [2, 1], near its left edge
    assert cell_of(GRID, np.array([0.9, 0.1])) == (0, 0)  # just outside of the map
    assert cell_of(GRID, np.array([0.7, 0.25])) is None  # more than a cell from the centre of any
    assert cell_of(GRID, np.array([np.nan, np.nan])) is None


@pytest.mark.example
def test_detections_are_put_on_the_floor() -> None:
    scale = np.diag([0.01, 0.01, 1.0])  # a pixel is a centimetre
    here = Ground(scale, np.array([1.0, 0.0, 2.0]), (640, 480), calibrated=True)
    one = Detection((320.0, 150.0), 1.0, "blob", "red", 1.0, 10.0)
    (found,) = located(here, GRID, [one])
    assert found.point_m == pytest.approx((2.1, 0.75))  # half way between the camera and (3.2, 1.5), being half as high
    assert found.cell == (1, 1)  # [2, 1] is a wall; of its free neighbours this centre is nearest
    assert located(here, GRID, []) == ()
