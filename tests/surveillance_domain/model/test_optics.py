"""The pinhole camera against hand-computed numbers and a camera written differently."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.model.optics import (
    depth_m,
    horizontal_fov_deg,
    in_picture,
    orientation,
    reach_m,
    within_depth,
)
from surveillance_domain.site.camera import Camera, Mount, Preset


def camera(**changes: object) -> Camera:
    mount = {"position_m": (0.0, 0.0, 2.5), **changes.pop("mount", {})}  # type: ignore[dict-item]
    return Camera.model_validate(
        {
            "name": "c",
            "mount": mount,
            "zoom_hfov": ((1, 90.0), (3, 30.0)),
            "image": {"width": 800, "height": 400},
            "max_depth_m": 10.0,
            "presets": ({"name": "p", "pan": 0, "tilt": 0, "zoom": 1},),
            **changes,
        }
    )


def preset(pan: float = 0.0, tilt: float = 0.0, zoom: float = 1.0) -> Preset:
    return Preset(name="p", pan=pan, tilt=tilt, zoom=zoom)


@pytest.mark.example
def test_the_focal_length_is_interpolated_between_zooms() -> None:
    table = ((1.0, 90.0), (3.0, 30.0))
    assert horizontal_fov_deg(table, 1.0) == pytest.approx(90)
    assert horizontal_fov_deg(table, 3.0) == pytest.approx(30)
    # focal lengths 1 and 1 / tan 15 deg = 3.7321; half way 2.36603, and 2 atan(1 / 2.36603) = 45.8227 deg
    assert horizontal_fov_deg(table, 2.0) == pytest.approx(45.8227, abs=1e-4)


@pytest.mark.example
@pytest.mark.parametrize(
    ("mount", "pan", "tilt", "forward"),
    [
        ({}, 0, 0, (1, 0, 0)),
        ({"yaw_deg": 90}, 0, 0, (0, 1, 0)),
        ({}, 90, 0, (0, -1, 0)),  # positive pan turns clockwise: to the right
        ({"pan_clockwise": False}, 90, 0, (0, 1, 0)),
        ({}, 0, -90, (0, 0, -1)),
        ({"yaw_deg": 90}, 90, 0, (1, 0, 0)),
        ({"pitch_deg": -90}, 0, 0, (0, 0, -1)),
        ({"roll_deg": 90}, 0, 90, (0, -1, 0)),  # rolled so that left is up: its own up points to the right
        ({"inverted": True}, 90, 0, (0, 1, 0)),  # hangs upside down: its clockwise is ours counter-clockwise
        ({"inverted": True}, 0, 90, (0, 0, -1)),  # and its up is down
        ({"inverted": True, "yaw_deg": 90}, 0, 0, (0, 1, 0)),
    ],
)
def test_the_optical_axis(mount: dict[str, object], pan: float, tilt: float, forward: tuple[float, ...]) -> None:
    axes = orientation(Mount.model_validate({"position_m": (0.0, 0.0, 1.0), **mount}), float(pan), float(tilt))
    assert axes[:, 0] == pytest.approx(forward, abs=1e-12)
    assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)


@pytest.mark.example
def test_the_depth_follows_en_62676_4() -> None:
    # 800 / (2 * 125 * tan 45 deg) = 3.2 m; at zoom 3: 800 / (2 * 125 * tan 15 deg) = 11.943 m
    recognise = camera(required_px_per_m=125.0, max_depth_m=None)
    assert depth_m(recognise, preset()) == pytest.approx(3.2)
    assert depth_m(recognise, preset(zoom=3.0)) == pytest.approx(11.943, abs=1e-3)
    assert depth_m(camera(required_px_per_m=125.0, max_depth_m=3.0), preset()) == 3.0
    assert depth_m(camera(required_px_per_m=125.0, max_depth_m=12.0), preset()) == pytest.approx(3.2)


@pytest.mark.example
def test_what_projects_into_the_picture() -> None:
    # 90 degrees wide, half as high: |left| <= forward, |up| <= forward / 2. 2.5 m up, level: the floor from 5 m on.
    points = np.array([[4.9, 0, 0], [5.1, 0, 0], [6, 5.9, 0], [6, 6.1, 0], [6, -6.1, 0], [-6, 0, 0]], dtype=float)
    assert in_picture(camera(), preset(), points).tolist() == [False, True, True, False, False, False]


@pytest.mark.example
def test_the_depth_is_measured_along_the_optical_axis() -> None:
    points = np.array([[9.9, 9.0, 0], [10.1, 0, 0]])
    assert within_depth(camera(), preset(), points).tolist() == [True, False]
    # Tilted 30 degrees down, a point on the floor at x = 8: 8 cos 30 + 2.5 sin 30 = 8.18 m along the axis; at 11: 10.78
    assert within_depth(camera(), preset(tilt=-30.0), np.array([[8.0, 0, 0], [11.0, 0, 0]])).tolist() == [True, False]


@pytest.mark.property
@given(
    yaw=st.floats(-180, 180),
    pan=st.floats(-170, 170),
    tilt=st.floats(-80, 20),
    zoom=st.floats(1, 3),
    clockwise=st.booleans(),
    points=st.lists(st.tuples(st.floats(-9, 9), st.floats(-9, 9)), min_size=1, max_size=8),
)
def test_it_agrees_with_angles_taken_one_after_the_other(
    yaw: float, pan: float, tilt: float, zoom: float, clockwise: bool, points: list[tuple[float, float]]
) -> None:
    one = camera(mount={"yaw_deg": yaw, "pan_clockwise": clockwise})
    shown = in_picture(one, preset(pan, tilt, zoom), np.array([(x, y, 0.0) for x, y in points]))
    half_width = math.tan(math.radians(horizontal_fov_deg(one.zoom_hfov, zoom)) / 2)
    heading = math.radians(yaw - pan if clockwise else yaw + pan)
    for (x, y), found in zip(points, shown.tolist(), strict=True):
        ahead = x * math.cos(heading) + y * math.sin(heading)
        left = -x * math.sin(heading) + y * math.cos(heading)
        forward = ahead * math.cos(math.radians(tilt)) - 2.5 * math.sin(math.radians(tilt))
        up = -ahead * math.sin(math.radians(tilt)) - 2.5 * math.cos(math.radians(tilt))
        margins = [forward, half_width * forward - abs(left), half_width / 2 * forward - abs(up)]
        if min(abs(margin) for margin in margins) > 1e-6:
            assert found == (min(margins) > 0)


@pytest.mark.property
@given(pan=st.floats(-170, 170), tilt=st.floats(-80, 0), zoom=st.floats(1, 3), seed=st.integers(0, 2**32 - 1))
def test_nothing_in_the_field_of_view_lies_beyond_its_reach(pan: float, tilt: float, zoom: float, seed: int) -> None:
    one, where = camera(), preset(pan, tilt, zoom)
    points = np.pad(np.random.default_rng(seed).uniform(-30, 30, (200, 2)), ((0, 0), (0, 1)))
    seen = in_picture(one, where, points) & within_depth(one, where, points)
    assert np.all(np.linalg.norm(points[seen] - [0, 0, 2.5], axis=1) <= reach_m(one, where) + 1e-9)
