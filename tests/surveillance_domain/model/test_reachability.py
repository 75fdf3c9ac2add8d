"""Which presets are reachable within a step."""

from __future__ import annotations

import pytest

from surveillance_domain.model.reachability import reachable
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site


def camera(**changes: object) -> Camera:
    places = [(-30.0, -20.0, 1.0), (0.0, -20.0, 1.0), (60.0, -20.0, 1001.0)]
    return Camera.model_validate(
        {
            "name": "c",
            "mount": {"position_m": (0.0, 0.0, 2.5)},
            "zoom_hfov": ((1, 48.0), (9999, 2.7)),
            "image": {"width": 704, "height": 576},
            "max_depth_m": 10.0,
            "presets": tuple(
                {"name": str(i), "pan": pan, "tilt": tilt, "zoom": zoom} for i, (pan, tilt, zoom) in enumerate(places)
            ),
            **changes,
        }
    )


@pytest.mark.example
def test_without_speeds_everything_is_reachable() -> None:
    assert reachable(camera(settle_s=100.0), 0.1).all()


@pytest.mark.example
def test_pan_and_settling_count() -> None:
    # 30, 60 and 90 degrees at 60 degrees a second: 0.5, 1.0 and 1.5 s, and 0.3 s to settle
    slow = camera(pan_deg_per_s=60.0, settle_s=0.3)
    near = [[True, True, False], [True, True, False], [False, False, True]]
    assert reachable(slow, 0.8).tolist() == near
    assert reachable(slow, 0.79).tolist() == [[True, False, False], [False, True, False], [False, False, True]]
    assert reachable(slow, 1.3).tolist() == [[True, True, False], [True, True, True], [False, True, True]]
    assert reachable(slow, 1.8).all()


@pytest.mark.example
def test_the_slowest_axis_counts() -> None:
    # zoom 1000 at 500 a second: 2 s, slower than any pan
    slow = camera(pan_deg_per_s=60.0, zoom_per_s=500.0)
    assert reachable(slow, 1.9).tolist() == [[True, True, False], [True, True, False], [False, False, True]]
    assert reachable(slow, 2.0).all()


@pytest.mark.example
def test_staying_is_always_possible() -> None:
    assert reachable(camera(pan_deg_per_s=1.0, settle_s=5.0), 0.1).diagonal().all()


@pytest.mark.example
@pytest.mark.parametrize("name", ["hall", "corridor", "junction", "lego", "tiny", "tiny-3", "micro"])
def test_every_preset_of_the_built_in_sites_is_reachable_in_one_step(name: str) -> None:
    site = load_site(name)
    assert all(reachable(camera, site.control.step_s).all() for camera in site.cameras)
