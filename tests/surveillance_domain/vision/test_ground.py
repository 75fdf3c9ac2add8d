"""From pixels to the floor and back, by hand and against the pinhole model."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera
from surveillance_domain.vision.agreement import disagreement_m
from surveillance_domain.vision.ground import ground, preset_at

SIZE = (801, 401)


def camera(homography: object = None, **mount: object) -> Camera:
    """2 m above the origin, looking north and 45 degrees down; focal length 400.5 pixels."""
    return Camera.model_validate(
        {
            "name": "c",
            "mount": {"position_m": (0.0, 0.0, 2.0), "yaw_deg": 90, **mount},
            "zoom_hfov": ((1, 90.0), (3, 30.0)),
            "image": {"width": SIZE[0], "height": SIZE[1]},
            "max_depth_m": 10.0,
            "presets": (
                {"name": "low", "pan": 0, "tilt": -45, "zoom": 1, "homography": homography},
                {"name": "high", "pan": 0, "tilt": -20, "zoom": 3},
            ),
        }
    )


LOW = Position(0.0, -45.0, 1.0)
CENTRE = np.array([[400.0, 200.0]])


@pytest.mark.example
def test_the_middle_of_the_picture_by_hand() -> None:
    here = ground(camera(), LOW, SIZE)
    floor, higher = (here.on_floor(CENTRE, np.array([height]))[0] for height in (0.0, 0.5))
    assert floor == pytest.approx([0.0, 2.0])  # as far ahead as the camera is high
    assert higher == pytest.approx([0.0, 1.5])  # half a metre less deep, half a metre nearer
    assert here.in_picture(np.array([[0.0, 1.5]]), np.array([0.5]))[0] == pytest.approx(CENTRE[0])
    assert not here.calibrated


@pytest.mark.example
def test_what_does_not_meet_the_floor_is_nan() -> None:
    here = ground(camera(), Position(0.0, 0.0, 1.0), SIZE)
    assert np.isnan(here.on_floor(np.array([[400.0, 100.0]]), np.zeros(1))).all()  # above the horizon
    assert np.isnan(here.on_floor(np.array([[400.0, 300.0]]), np.array([2.0]))).all()  # as high as the camera
    assert np.isnan(here.in_picture(np.array([[0.0, -1.0]]), np.zeros(1))).all()  # behind it


@pytest.mark.example
def test_the_position_read_back_counts_not_that_of_the_preset() -> None:
    turned = ground(camera(), Position(-90.0, -45.0, 1.0), SIZE)  # a quarter turn to the left: west
    assert turned.on_floor(CENTRE, np.zeros(1))[0] == pytest.approx([-2.0, 0.0])


@pytest.mark.example
def test_a_preset_with_a_homography_uses_it() -> None:
    flat = [[0.01, 0, 1.0], [0, -0.01, 5.0], [0, 0, 1.0]]
    here = ground(camera(flat), Position(0.1, -45.1, None), SIZE)  # within tolerance; the zoom is not told
    assert here.calibrated
    assert here.on_floor(CENTRE, np.zeros(1))[0] == pytest.approx([5.0, 3.0])
    beside = ground(camera(flat), Position(1.0, -45.0, 1.0), SIZE)
    assert not beside.calibrated


@pytest.mark.example
def test_the_sign_of_a_homography_does_not_matter() -> None:
    known = pinhole(camera(), 0.0, -45.0, 1.0).homography()
    for sign in (1, -1):
        here = ground(camera((sign * known).tolist()), LOW, SIZE)
        assert here.on_floor(CENTRE, np.zeros(1))[0] == pytest.approx([0.0, 2.0])
        assert np.isnan(here.on_floor(np.array([[400.0, -2000.0]]), np.zeros(1))).all()


@pytest.mark.example
def test_a_homography_is_scaled_to_the_picture() -> None:
    known = pinhole(camera(), 0.0, -45.0, 1.0).homography().tolist()
    places = np.array([[0.3, 2.4], [-0.5, 1.5]])
    for size in (SIZE, (1602, 802)):
        pixels = pinhole(camera(), 0.0, -45.0, 1.0, size).project(np.pad(places, ((0, 0), (0, 1))))
        here = ground(camera(known), LOW, size)
        assert here.calibrated
        np.testing.assert_allclose(here.on_floor(pixels, np.zeros(2)), places, atol=1e-9)


@pytest.mark.property
@given(
    pan=st.floats(-170, 170),
    tilt=st.floats(-85, -25),
    u=st.floats(0, 800),
    v=st.floats(0, 400),
    height=st.floats(0, 1.5),
    roll=st.floats(-5, 5),
)
def test_points_at_a_height_agree_with_the_pinhole(
    pan: float, tilt: float, u: float, v: float, height: float, roll: float
) -> None:
    described, pixel, heights = camera(roll_deg=roll), np.array([[u, v]]), np.array([height])
    here, view = ground(described, Position(pan, tilt, 3.0), SIZE), pinhole(described, pan, tilt, 3.0, SIZE)
    found = here.on_floor(pixel, heights)
    np.testing.assert_allclose(found, view.on_plane(pixel, height), atol=1e-7)
    if np.isfinite(found).all():
        np.testing.assert_allclose(here.in_picture(found, heights), pixel, atol=1e-5)


@pytest.mark.example
def test_presets_are_known_by_their_positions() -> None:
    found = [preset_at(camera(), Position(*at)) for at in ((0.0, -45.0, 1.0), (0.1, -20.1, 3.0), (5.0, -45.0, 1.0))]
    assert [preset and preset.name for preset in found] == ["low", "high", None]


@pytest.mark.example
def test_homography_and_mount_agree_or_do_not() -> None:
    places = np.array([[0.0, 2.0], [0.5, 2.5], [-0.5, 1.6]])
    known = pinhole(camera(), 0.0, -45.0, 1.0).homography()
    shifted = np.array([[1, 0, 0.3], [0, 1, -0.4], [0, 0, 1]]) @ known
    assert disagreement_m(camera(), camera().presets[0], places) == pytest.approx(0, abs=1e-9)
    assert disagreement_m(camera(known.tolist()), camera(known.tolist()).presets[0], places) < 1e-9
    moved = camera(shifted.tolist())
    assert disagreement_m(moved, moved.presets[0], places) == pytest.approx(math.hypot(0.3, 0.4))
