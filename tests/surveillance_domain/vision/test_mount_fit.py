"""The mount of a camera from points in some of its presets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.site.camera import Camera
from surveillance_domain.vision.homography import CalibrationError
from surveillance_domain.vision.mount_fit import fit_mount
from surveillance_domain.vision.points import FloorPoint
from tests.known_points import lego_camera, points_of
from tests.pictured_targets import preset_view

SITE_SAYS = lego_camera()
INNER = ((1.3, 1.1), (1.7, 1.1), (1.3, 1.5), (1.7, 1.5))
LEFT = ((0.7, 0.7), (0.9, 1.0), (0.5, 1.0), (0.7, 1.3))
PROBES = np.array([[200.0, 450.0], [351.5, 287.5], [500.0, 150.0]])


def with_longer_lens(camera: Camera, scale: float) -> Camera:
    half = np.tan(np.radians(48.0) / 2) / scale
    pairs = ((1.0, float(2 * np.degrees(np.arctan(half)))), camera.zoom_hfov[1])
    return camera.model_copy(update={"zoom_hfov": pairs})


def worst_error_m(fitted: Camera, truth: Camera, preset: str) -> float:
    """How far off the floor is, in a preset."""
    found, true = (preset_view(one, preset).on_plane(PROBES) for one in (fitted, truth))
    return float(np.abs(found - true).max())


def seen_by(truth: Camera, noise_px: float = 0.0, seed: int = 0) -> list[FloorPoint]:
    """Four points in the middle, four on the left, none on the right."""
    middle = points_of(truth, "middle", INNER, noise_px=noise_px, seed=seed)
    return middle + points_of(truth, "left", LEFT, noise_px=noise_px, seed=seed + 1)


@pytest.mark.example
def test_a_true_mount_stays() -> None:
    fit = fit_mount(SITE_SAYS, seen_by(SITE_SAYS))
    assert fit.camera.mount == SITE_SAYS.mount
    assert fit.focal_scale == pytest.approx(1, abs=1e-4)
    assert fit.residual_px < 0.1
    assert all(one.fits for one in fit.points)


@pytest.mark.property
@settings(max_examples=12)
@given(
    yaw=st.floats(-15, 15),
    pitch=st.floats(-4, 4),
    roll=st.floats(-4, 4),
    scale=st.floats(0.95, 1.05),
    seed=st.integers(0, 1000),
)
def test_all_presets_are_served(yaw: float, pitch: float, roll: float, scale: float, seed: int) -> None:
    # The pan offset of a bumped camera is in the yaw. Points of half a pixel of noise; a pixel is 2 to 5 mm here.
    truth = with_longer_lens(lego_camera(yaw_deg=90 + 0.3 * yaw, pitch_deg=pitch, roll_deg=roll), scale)
    fit = fit_mount(SITE_SAYS, seen_by(truth, 0.5, seed))
    assert fit.residual_px < 1.5
    assert worst_error_m(fit.camera, truth, "middle") < 0.03
    assert worst_error_m(fit.camera, truth, "right") < 0.10  # where no point was seen


@pytest.mark.example
@pytest.mark.parametrize("off", [100.0, 180.0, -75.0])
def test_the_yaw_may_be_all_wrong(off: float) -> None:
    says = lego_camera(yaw_deg=(90 + off + 180) % 360 - 180)
    fit = fit_mount(says, seen_by(SITE_SAYS))
    assert fit.camera.mount.yaw_deg == pytest.approx(90, abs=0.05)
    assert fit.residual_px < 0.5
    assert not any(one.pixels < 300 for one in fit.before)  # far off, or not in front of the camera at all


@pytest.mark.example
def test_where_it_hangs_is_fitted_if_asked() -> None:
    truth = lego_camera(position_m=(1.6, -0.4, 1.3), pitch_deg=1.0)
    places = [(0.9, 1.0), (2.1, 1.0), (1.0, 1.9), (2.0, 1.9), (1.5, 1.4)]
    points = points_of(truth, "middle", places) + points_of(truth, "left", LEFT)
    with_position = fit_mount(SITE_SAYS, points, position=True)
    without = fit_mount(SITE_SAYS, points)
    assert with_position.camera.mount.position_m == pytest.approx((1.6, -0.4, 1.3), abs=0.01)
    assert with_position.residual_px < 0.5 < without.residual_px


@pytest.mark.example
def test_a_wrong_point_is_named_and_does_no_harm() -> None:
    truth = lego_camera(yaw_deg=93.0, pitch_deg=-2.0)
    points = seen_by(truth, 0.3)
    points[5] = replace(points[5], place_m=(1.9, 1.0))  # x and y swapped, say
    fit = fit_mount(SITE_SAYS, points)
    assert [one.point.name for one in fit.points if not one.fits] == ["left 1"]
    assert fit.camera.mount.yaw_deg == pytest.approx(93, abs=0.3)
    assert worst_error_m(fit.camera, truth, "right") < 0.05


@pytest.mark.example
def test_two_points_turn_the_mount_and_leave_the_rest() -> None:
    truth = lego_camera(yaw_deg=97.0)
    fit = fit_mount(SITE_SAYS, points_of(truth, "middle", INNER[:2]))
    assert fit.camera.mount.yaw_deg == pytest.approx(97, abs=0.2)
    assert fit.camera.mount.pitch_deg == pytest.approx(0, abs=0.3)
    assert fit.camera.mount.position_m == SITE_SAYS.mount.position_m


@pytest.mark.example
def test_the_focal_length_stays_if_asked() -> None:
    fit = fit_mount(SITE_SAYS, seen_by(with_longer_lens(SITE_SAYS, 1.05)), focal=False)
    assert fit.focal_scale == 1.0
    assert fit.camera.zoom_hfov == SITE_SAYS.zoom_hfov


@pytest.mark.example
def test_homographies_are_not_believed_any_more() -> None:
    flat = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    presets = tuple(preset.model_copy(update={"homography": flat}) for preset in SITE_SAYS.presets)
    fit = fit_mount(SITE_SAYS.model_copy(update={"presets": presets}), seen_by(SITE_SAYS))
    assert [preset.homography for preset in fit.camera.presets] == [None, None, None]
    assert fit.residual_px < 0.1


@pytest.mark.example
def test_one_point_is_too_little() -> None:
    with pytest.raises(CalibrationError, match="1 points; the mount takes at least 2"):
        fit_mount(SITE_SAYS, points_of(SITE_SAYS, "middle", INNER[:1]))
