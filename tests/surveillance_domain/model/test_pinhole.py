"""The pinhole: by hand, against the optics that fields of view are made of, and there and back."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from surveillance_domain.model.optics import in_picture
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera, Preset

angles = st.floats(-180, 180)


def camera(**mount: object) -> Camera:
    table = {"position_m": (0.0, 0.0, 2.0), **mount}
    return Camera.model_validate(
        {
            "name": "north",
            "mount": table,
            "presets": [{"name": "a", "pan": 0.0, "tilt": 0.0, "zoom": 1.0}],
            "zoom_hfov": [(1.0, 90.0), (100.0, 10.0)],
            "image": {"width": 200, "height": 100},
            "max_depth_m": 5.0,
        }
    )


@st.composite
def cameras(draw: st.DrawFn) -> Camera:
    return camera(
        position_m=(draw(st.floats(-5, 5)), draw(st.floats(-5, 5)), draw(st.floats(0.5, 5))),
        yaw_deg=draw(angles),
        pitch_deg=draw(st.floats(-20, 20)),
        roll_deg=draw(st.floats(-20, 20)),
        pan_clockwise=draw(st.booleans()),
        inverted=draw(st.booleans()),
    )


views = st.tuples(cameras(), angles, st.floats(-90, 90), st.floats(1, 100))


@pytest.mark.example
def test_by_hand() -> None:
    level = pinhole(camera(), 0.0, 0.0, 1.0)  # looks along +x, 90 degrees wide: one metre away it sees two metres
    assert level.focal_px == pytest.approx(100.0)
    assert level.centre_px == (99.5, 49.5)
    points = np.array([[10.0, 0.0, 2.0], [10.0, 10.0, 2.0], [10.0, -10.0, 2.0], [10.0, 0.0, 7.0], [10.0, 0.0, -3.0]])
    expected = [[99.5, 49.5], [-0.5, 49.5], [199.5, 49.5], [99.5, -0.5], [99.5, 99.5]]
    np.testing.assert_allclose(level.project(points), expected, atol=1e-9)
    assert np.isnan(level.project(np.array([[-1.0, 0.0, 2.0], [0.0, 0.0, 2.0]]))).all()
    np.testing.assert_allclose(level.on_plane(np.array([[99.5, 99.5], [199.5, 99.5]])), [[4.0, 0.0], [4.0, -4.0]])
    assert np.isnan(level.on_plane(np.array([[99.5, 49.5], [99.5, 20.0]]))).all()  # level, and up
    turned = pinhole(camera(), 90.0, -45.0, 1.0)  # positive pan turns clockwise: along -y, and down
    np.testing.assert_allclose(turned.on_plane(np.array([[99.5, 49.5]])), [[0.0, -2.0]], atol=1e-9)
    np.testing.assert_allclose(turned.on_plane(np.array([[99.5, 49.5]]), 1.0), [[0.0, -1.0]], atol=1e-9)
    hanging = pinhole(camera(inverted=True), 0.0, 45.0, 1.0)  # upside down, positive tilt looks down
    np.testing.assert_allclose(hanging.on_plane(np.array([[99.5, 49.5]])), [[2.0, 0.0]], atol=1e-9)
    assert hanging.project(np.array([[3.0, 0.0, 0.0]]))[0, 1] > 49.5  # what is farther is lower in its picture


@pytest.mark.property
@given(views, st.floats(-0.5, 199.5), st.floats(-0.5, 99.5), st.floats(0, 3))
def test_from_pixel_to_plane_and_back(
    view: tuple[Camera, float, float, float], u: float, v: float, height: float
) -> None:
    hole = pinhole(*view)
    pixel = np.array([[u, v]])
    place = hole.on_plane(pixel, height)
    assume(np.isfinite(place).all() and np.abs(place).max() < 1000)
    back = hole.project(np.array([[*place[0], height]]))
    np.testing.assert_allclose(back, pixel, atol=1e-5)


@pytest.mark.property
@given(views, st.floats(-20, 20), st.floats(-20, 20), st.floats(0, 3))
def test_projection_and_homography_say_the_same(
    view: tuple[Camera, float, float, float], x: float, y: float, z: float
) -> None:
    hole = pinhole(*view)
    assume(abs(hole.position_m[2] - z) > 0.05)
    pixel = hole.project(np.array([[x, y, z]]))
    assume(np.isfinite(pixel).all() and np.abs(pixel).max() < 1e4)
    homogeneous = hole.projection @ np.array([x, y, z, 1.0])
    forward = float((np.array([x, y, z]) - hole.position_m) @ hole.axes[:, 0])
    assert homogeneous[2] == pytest.approx(forward, abs=1e-9)
    assume(forward > 0.05)
    np.testing.assert_allclose(homogeneous[:2] / homogeneous[2], pixel[0], atol=1e-6)
    place = hole.homography(z) @ np.array([*pixel[0], 1.0])
    assert place[2] == pytest.approx(1 / forward, rel=1e-6, abs=1e-9)
    np.testing.assert_allclose(place[:2] / place[2], [x, y], atol=1e-4)


@pytest.mark.property
@given(cameras(), angles, st.floats(-90, 90), st.floats(1, 100), st.floats(-20, 20), st.floats(-20, 20))
def test_pixels_agree_with_the_fields_of_view(
    one: Camera, pan: float, tilt: float, zoom: float, x: float, y: float
) -> None:
    """A point is in the picture of `optics` exactly if its pixel lies on the sensor."""
    preset = Preset(name="a", pan=pan, tilt=tilt, zoom=zoom)
    point = np.array([[x, y, 0.0]])
    u, v = pinhole(one, pan, tilt, zoom).project(point)[0]
    edges = np.array([u + 0.5, 199.5 - u, v + 0.5, 99.5 - v])
    assume(not (np.abs(edges) < 1e-6).any())
    assert bool(in_picture(one, preset, point)[0]) == bool((edges > 0).all())


@pytest.mark.example
def test_another_size_of_picture_sees_the_same() -> None:
    half = pinhole(camera(), 10.0, -30.0, 1.0, size=(100, 50))
    whole = pinhole(camera(), 10.0, -30.0, 1.0)
    assert half.focal_px == pytest.approx(whole.focal_px / 2)
    point = np.array([[3.0, 1.0, 0.0]])
    np.testing.assert_allclose((half.project(point) + 0.5) * 2, whole.project(point) + 0.5)


@pytest.mark.example
def test_a_plane_seen_edge_on() -> None:
    with pytest.raises(ValueError, match="height 2 m sees the plane at that height edge on"):
        pinhole(camera(), 0.0, 0.0, 1.0).homography(2.0)
