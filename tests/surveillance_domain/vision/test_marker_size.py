"""How large a marker is in the picture, by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Markers
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.marker_size import LEAST_SIDE_PX, marker_side_px, marker_sides_px
from tests.pictured_targets import pixels_of

MARKERS = Markers(side_m=0.2, height_m=0.0)


def camera(tilt: float) -> Camera:
    return Camera.model_validate(
        {
            "name": "c",
            "mount": {"position_m": (3.0, 4.0, 2.0)},
            "zoom_hfov": ((1, 90.0), (3, 30.0)),
            "image": {"width": 800, "height": 400},
            "max_depth_m": 10.0,
            "presets": ({"name": "p", "pan": 0, "tilt": tilt, "zoom": 1},),
        }
    )


@pytest.mark.example
def test_straight_below() -> None:
    # focal length 400 pixels, 2 m away: 0.2 m are 40 pixels along and across
    down = camera(-90)
    assert marker_side_px(down, down.presets[0], MARKERS, 0.0) == pytest.approx(40)


@pytest.mark.example
def test_far_ahead_a_marker_is_wide_and_flat() -> None:
    # Looking level, at 10 m: edges across at 9.9 and 10.1 m are 400 * 0.2 / depth long; the edges between them go from
    # (0.1, 2) / 9.9 to (0.1, 2) / 10.1, times 400, right and down.
    level = camera(0)
    across = [400 * 0.2 / depth for depth in (9.9, 10.1)]
    along = 400 * (1 / 9.9 - 1 / 10.1) * math.hypot(0.1, 2.0)
    expected = (sum(across) + 2 * along) / 4
    assert marker_side_px(level, level.presets[0], MARKERS, 10.0) == pytest.approx(expected)


@pytest.mark.example
def test_behind_the_camera_there_is_none() -> None:
    level = camera(0)
    view = pinhole(level, 0.0, 0.0, 1.0)
    sides = marker_sides_px(view, MARKERS, np.array([[2.0, 4.0], [5.0, 4.0]]))
    assert np.isnan(sides[0])
    assert sides[1] > 0


@pytest.mark.example
def test_the_lego_site_is_made_for_its_markers() -> None:
    site = load_site("lego")
    assert site.markers is not None
    south = site.cameras[0]
    assert marker_side_px(south, south.presets[1], site.markers, 2.4) > LEAST_SIDE_PX
    assert marker_side_px(south, south.presets[1], site.markers, 6.0) < LEAST_SIDE_PX


@pytest.mark.example
def test_it_is_what_the_detector_measures() -> None:
    site = load_site("lego")
    assert site.markers is not None
    south = site.cameras[0]
    view = pinhole(south, 0.0, -40.0, 1.0)
    (found,) = MarkerDetector(site.markers).detect(pixels_of(site, view, [(1.5, 1.2)], [0.0]))
    assert found.size_px == pytest.approx(marker_side_px(south, south.presets[1], site.markers, 1.5), rel=0.04)
