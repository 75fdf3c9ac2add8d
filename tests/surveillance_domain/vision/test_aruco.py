"""Markers in rendered pictures: which ones, where, how large."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Markers
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.marker_size import LEAST_SIDE_PX, marker_sides_px
from surveillance_domain.vision.observe import located
from tests.pictured_targets import pixels_of, seen_whole, watched

MARKERS = Markers(side_m=0.12, height_m=0.1)
LEGO = load_site("lego")
OVERHEAD = Camera.model_validate(
    {
        "name": "overhead",
        "mount": {"position_m": (1.0, 1.0, 2.1), "yaw_deg": 90},
        "zoom_hfov": ((1, 90.0), (9999, 10.0)),
        "image": {"width": 800, "height": 800},
        "max_depth_m": 10.0,
        "presets": ({"name": "down", "pan": 0, "tilt": -90, "zoom": 1},),
    }
)
DOWN = pinhole(OVERHEAD, 0.0, -90.0, 1.0)


@pytest.mark.example
def test_a_marker_below_the_camera() -> None:
    # The focal length is 400 / tan(45 degrees) = 400 pixels; the marker lies 2 m below the camera, so a metre is 200
    # pixels: 0.3 m to the right are 60, 0.2 m ahead 40 upwards, and the side of 0.12 m is 24.
    picture = pixels_of(watched(OVERHEAD, MARKERS), DOWN, [(1.3, 1.2)])
    (found,) = MarkerDetector(MARKERS).detect(picture)
    assert found.pixel == pytest.approx((399.5 + 60, 399.5 - 40), abs=0.5)
    assert found.size_px == pytest.approx(24, abs=1)
    assert (found.kind, found.identity, found.height_m) == ("marker", 0, 0.1)
    assert 0.9 < found.confidence <= 1.0


@pytest.mark.example
def test_every_marker_says_which_one_it_is() -> None:
    site = watched(OVERHEAD, MARKERS)
    places = [(0.4, 0.4), (1.6, 0.4), (0.4, 1.6), (1.6, 1.6), (1.0, 1.0)]
    found = MarkerDetector(MARKERS).detect(pixels_of(site, DOWN, places, [0, 1, 2, 3, 4]))
    columns = {one.identity: one.pixel for one in found}
    assert sorted(columns) == [0, 1, 2, 3, 4]  # red, blue, green, yellow and white of the lego site
    assert columns[0][0] < columns[4][0] < columns[1][0]
    assert columns[2][1] < columns[4][1] < columns[0][1]


@pytest.mark.example
def test_nothing_is_found_where_nothing_is() -> None:
    empty = pixels_of(watched(OVERHEAD, MARKERS), DOWN, [])
    assert MarkerDetector(MARKERS).detect(empty) == ()
    assert MarkerDetector(MARKERS).detect(np.zeros((1, 1, 3), dtype=np.uint8)) == ()


@pytest.mark.example
def test_a_marker_of_another_dictionary_is_not_read() -> None:
    picture = pixels_of(watched(OVERHEAD, MARKERS), DOWN, [(1.0, 1.0)])
    assert MarkerDetector(Markers(dictionary="6X6_250", side_m=0.12)).detect(picture) == ()


@pytest.mark.example
def test_a_marker_that_the_edge_cuts_is_not_found() -> None:
    # The upper right corner of the view is at (3.1, 3.1) on the floor, 0.1 m lower down at (3, 3).
    picture = pixels_of(watched(OVERHEAD, MARKERS), DOWN, [(3.0, 1.0)])
    assert MarkerDetector(MARKERS).detect(picture) == ()


@pytest.mark.example
def test_a_flat_marker_of_27_pixels_is_read_whatever_the_noise() -> None:
    camera = LEGO.cameras[1]
    view = pinhole(camera, 40.0, -40.0, 1.0)
    (place,) = view.on_plane(np.array([[70.4, 92.16]]))
    assert marker_sides_px(view, MARKERS, place[None, :])[0] == pytest.approx(26.7, abs=0.1)
    found = [MarkerDetector(MARKERS).detect(pixels_of(LEGO, view, [place], [5.21875])) for _ in range(20)]
    assert [[one.identity for one in each] for each in found] == [[0]] * 20


@pytest.mark.property
@settings(max_examples=40)
@given(
    camera=st.sampled_from(LEGO.cameras),
    preset=st.integers(0, 2),
    across=st.floats(0.1, 0.9),
    down=st.floats(0.1, 0.9),
    heading=st.floats(0, 2 * math.pi),
    zoom=st.sampled_from([1.0, 800.0]),
)
def test_a_marker_in_view_is_found_where_it_is(
    camera: Camera, preset: int, across: float, down: float, heading: float, zoom: float
) -> None:
    at = camera.presets[preset]
    view = pinhole(camera, at.pan, at.tilt, zoom)
    (place,) = view.on_plane(np.array([[across * view.width, down * view.height]]))
    assume(seen_whole(view, place, 0.142, (0.0, 0.1)))
    assume(marker_sides_px(view, MARKERS, place[None, :])[0] >= LEAST_SIDE_PX)
    picture = pixels_of(LEGO, view, [place], [heading])
    found = MarkerDetector(LEGO.markers or MARKERS).detect(picture)
    here = ground(camera, Position(at.pan, at.tilt, zoom), (view.width, view.height))
    (one,) = located(here, LEGO.grid, found)
    assert one.detection.identity == 0
    assert one.point_m == pytest.approx(tuple(place), abs=0.01)
