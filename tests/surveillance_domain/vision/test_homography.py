"""Homographies of presets from points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.vision.homography import CalibrationError, fit_homography
from surveillance_domain.vision.points import FloorPoint, root_mean_square
from tests.known_points import CORNERS, lego_camera, points_of
from tests.pictured_targets import preset_view

CAMERA = lego_camera()
PIXELS = np.array([[100.0, 500.0], [351.5, 287.5], [650.0, 60.0]])


def true_places(height_m: float = 0.0) -> np.ndarray:
    return preset_view(CAMERA, "middle").on_plane(PIXELS, height_m)


@pytest.mark.example
def test_exact_points_give_the_pinhole_back() -> None:
    fit = fit_homography(CAMERA, "middle", points_of(CAMERA, "middle"))
    np.testing.assert_allclose(fit.ground.on_floor(PIXELS, np.zeros(3)), true_places(), atol=1e-5)
    assert fit.checked
    assert fit.residual_px < 1e-3
    assert fit.residual_m < 1e-6
    assert abs(np.linalg.det(fit.ground.to_floor)) == pytest.approx(1)


@pytest.mark.example
def test_points_above_the_floor_are_brought_down_to_it() -> None:
    fit = fit_homography(CAMERA, "middle", points_of(CAMERA, "middle", height_m=0.1))
    np.testing.assert_allclose(fit.ground.on_floor(PIXELS, np.zeros(3)), true_places(), atol=1e-5)
    np.testing.assert_allclose(fit.ground.on_floor(PIXELS, np.full(3, 0.1)), true_places(0.1), atol=1e-5)
    assert fit.residual_m < 1e-6


@pytest.mark.example
def test_four_points_determine_it_and_check_nothing() -> None:
    fit = fit_homography(CAMERA, "middle", points_of(CAMERA, "middle", CORNERS[:4], noise_px=3.0))
    assert not fit.checked
    assert fit.residual_px < 1e-3  # whatever the noise


@pytest.mark.property
@settings(max_examples=20)
@given(seed=st.integers(0, 1000), wrong=st.integers(0, 11), away=st.floats(25, 150))
def test_a_wrong_point_is_named_and_does_no_harm(seed: int, wrong: int, away: float) -> None:
    places = [(x, y) for x in (0.9, 1.3, 1.7, 2.1) for y in (1.0, 1.4, 1.8)]
    points = points_of(CAMERA, "middle", places, noise_px=0.5, seed=seed)
    u, v = points[wrong].pixel
    points[wrong] = replace(points[wrong], pixel=(u + away, v))
    fit = fit_homography(CAMERA, "middle", points)
    assert [one.point.name for one in fit.points if not one.fits] == [f"middle {wrong}"]
    assert fit.residual_px < 1.5
    assert fit.points[wrong].pixels == pytest.approx(away, abs=5)
    # A pixel is 2 to 5 mm here; within the points the fit is as good as they are.
    assert np.abs(fit.ground.on_floor(PIXELS[1:2], np.zeros(1)) - true_places()[1:2]).max() < 0.01


@pytest.mark.example
def test_points_of_other_presets_do_not_count() -> None:
    points = points_of(CAMERA, "middle", CORNERS[:3]) + points_of(CAMERA, "left", [(0.6, 1.0), (0.3, 0.6)])
    with pytest.raises(CalibrationError, match='preset "middle": 3 points; a homography takes at least 4'):
        fit_homography(CAMERA, "middle", points)


@pytest.mark.example
def test_points_on_a_line_are_refused() -> None:
    line = [(1.0 + 0.2 * step, 1.0 + 0.1 * step) for step in range(5)]
    with pytest.raises(CalibrationError, match="all its points lie on one line; a homography takes two points or more"):
        fit_homography(CAMERA, "middle", points_of(CAMERA, "middle", line))


@pytest.mark.example
@pytest.mark.parametrize("count", [3, 5])
def test_one_point_beside_a_line_is_not_enough_and_the_line_is_named(count: int) -> None:
    line = [(1.0 + 0.2 * step, 1.0 + 0.1 * step) for step in range(count)]
    points = points_of(CAMERA, "middle", [*line[:2], (1.1, 1.6), *line[2:]])
    with pytest.raises(CalibrationError) as caught:
        fit_homography(CAMERA, "middle", points)
    on_it = [point.name for number, point in enumerate(points) if number != 2]
    assert f'preset "middle": {", ".join(on_it)} lie on one line' in str(caught.value)
    assert "(--mount)" in str(caught.value)
    beside = points_of(CAMERA, "middle", [(1.7, 1.6)])
    assert fit_homography(CAMERA, "middle", [*points, *beside]).residual_px < 1e-3


@pytest.mark.example
def test_points_of_which_most_disagree_are_refused() -> None:
    rng = np.random.default_rng(0)
    places, elsewhere = ([(x, y) for x, y in rng.uniform((1, 1), (2, 2), (12, 2)).tolist()] for _ in range(2))
    seen = points_of(CAMERA, "middle", places)
    points = [replace(one, place_m=place) for one, place in zip(seen, elsewhere, strict=True)]
    with pytest.raises(CalibrationError, match=r"only [45] of 12 points agree with one another"):
        fit_homography(CAMERA, "middle", points)


@pytest.mark.example
def test_points_as_high_as_the_camera_are_refused() -> None:
    high = FloorPoint("lamp", "middle", (10.0, 10.0), (1.0, 1.0), 1.2)
    with pytest.raises(CalibrationError, match="lamp: as high as the camera"):
        fit_homography(CAMERA, "middle", [*points_of(CAMERA, "middle"), high])


@pytest.mark.example
def test_root_mean_square_by_hand() -> None:
    assert root_mean_square([3.0, 4.0]) == pytest.approx(12.5**0.5)
    assert np.isnan(root_mean_square([]))
    assert np.isnan(root_mean_square([1.0, float("nan")]))
