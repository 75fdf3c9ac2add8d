"""Privacy masks that are set in a camera: directions behind them, and cells that leave its fields of view."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from surveillance_domain.model.optics import orientation
from surveillance_domain.model.privacy_masks import behind_masks, masked_points, own_angles
from surveillance_domain.model.views import build_views
from surveillance_domain.site.camera import Camera, Mount
from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site

HEAD = """
schema_version = 1
[map]
cell_m = 1.0
rows = [".....", ".....", ".....", ".....", "....."]
[[cameras]]
name = "a"
mount = { position_m = [0, 2.5, 2.0] }
zoom_hfov = [[1, 90.0]]
image = { width = 100, height = 100 }
max_depth_m = 9
presets = [{ name = "ahead", pan = 0, tilt = -45, zoom = 1 }, { name = "aside", pan = 40, tilt = -45, zoom = 1 }]
"""


def camera(pan: tuple[float, float], tilt: tuple[float, float], **mount: Any) -> Camera:
    table = {
        "name": "a",
        "mount": {"position_m": (0.0, 0.0, 2.0), **mount},
        "presets": [{"name": "p", "pan": 0.0, "tilt": -40.0, "zoom": 1.0}],
        "zoom_hfov": [(1.0, 48.0)],
        "image": {"width": 64, "height": 48},
        "max_depth_m": 5.0,
        "privacy_masks": [{"pan_deg": pan, "tilt_deg": tilt}],
    }
    return Camera.model_validate(table)


# From 2 m above the origin, looking along +x: 45 degrees down, and 0, 15 and 30 degrees to the left and right.
AHEAD, LEFT_15, LEFT_30, RIGHT_15, RIGHT_30 = (
    (2 * float(np.cos(np.radians(angle))), 2 * float(np.sin(np.radians(angle))), 0.0)
    for angle in (0.0, 15.0, 30.0, -15.0, -30.0)
)
PLACES = np.array([AHEAD, LEFT_15, LEFT_30, RIGHT_15, RIGHT_30])


@pytest.mark.example
@pytest.mark.parametrize(
    ("pan", "tilt", "mount", "hidden"),
    [
        ((-20, 10), (-60, -40), {}, [1, 1, 0, 0, 0]),  # positive pan turns clockwise: to the right
        ((-20, 10), (-60, -40), {"pan_clockwise": False}, [1, 0, 0, 1, 0]),
        ((-20, 10), (-60, -46), {}, [0, 0, 0, 0, 0]),
        ((-20, 10), (40, 60), {"inverted": True}, [1, 0, 0, 1, 0]),  # upside down: right is left, down is up
        ((-20, 10), (-60, -40), {"inverted": True}, [0, 0, 0, 0, 0]),
        ((170, -160), (-60, -40), {"yaw_deg": 180}, [1, 0, 0, 1, 0]),  # its back to them: 15 right is -165
        ((170, 200), (-60, -40), {"yaw_deg": 180}, [1, 0, 0, 1, 0]),
        ((-20, 10), (-2, 2), {"pitch_deg": -45}, [1, 1, 0, 0, 0]),  # ahead is at tilt 0, 15 left at pan -10.5, tilt -1
        ((170, -170), (-150, -120), {}, [1, 0, 0, 0, 0]),  # over its head: pan 180, tilt -135 is straight ahead
    ],
)
def test_places_behind_a_mask_by_hand(
    pan: tuple[float, float], tilt: tuple[float, float], mount: dict[str, Any], hidden: list[int]
) -> None:
    assert masked_points(camera(pan, tilt, **mount), PLACES).tolist() == [bool(one) for one in hidden]


MOUNTS = st.builds(
    lambda yaw, pitch, roll, clockwise, inverted: Mount(
        position_m=(0.0, 0.0, 2.0),
        yaw_deg=yaw,
        pitch_deg=pitch,
        roll_deg=roll,
        pan_clockwise=clockwise,
        inverted=inverted,
    ),
    *(st.floats(-180, 180) for _ in range(3)),
    st.booleans(),
    st.booleans(),
)


@pytest.mark.property
@given(
    mount=MOUNTS,
    pan=st.floats(-180, 180),
    tilt=st.floats(-89, 89),
    first=st.floats(-180, 180),
    wide=st.floats(1, 180),
    low=st.floats(-90, 89),
    high=st.floats(1, 90),
)
def test_the_camera_turned_to_a_direction_reads_its_own_angles(
    mount: Mount, pan: float, tilt: float, first: float, wide: float, low: float, high: float
) -> None:
    ray = orientation(mount, pan, tilt)[:, 0][None]
    found_pan, found_tilt = own_angles(mount, ray)
    assert abs((found_pan[0] - pan + 180) % 360 - 180) < 1e-6
    assert abs(found_tilt[0] - tilt) < 1e-6
    last, top = first + wide if first + wide <= 180 else first + wide - 360, max(high, low + 1)
    masked = camera((first, last), (low, top)).model_copy(update={"mount": mount})
    turn = (pan - first) % 360
    margins = [abs(turn), abs(turn - 360), abs(turn - wide), abs(tilt - low), abs(tilt - top)]
    if min(margins) > 1e-6:
        assert bool(behind_masks(masked, 3.0 * ray)[0]) == (turn < wide and low < tilt < top)


@pytest.mark.example
def test_cells_behind_a_mask_leave_every_field_of_view(tmp_path: Path) -> None:
    file = tmp_path / "site.toml"
    file.write_text(HEAD, encoding="utf-8")
    plain = build_views(load_site(file)).detection[0] > 0
    file.write_text(HEAD + "privacy_masks = [{ pan_deg = [-90, -1], tilt_deg = [-90, -10] }]\n", encoding="utf-8")
    site = load_site(file)
    masked = build_views(site).detection[0] > 0
    left = site.grid.centres_m[:, 1] > 2.6  # of the camera, which looks along +x from y = 2.5
    assert plain[:, left].any(axis=1).all()
    np.testing.assert_array_equal(masked, plain & ~left)


@pytest.mark.example
def test_a_preset_that_sees_nothing_but_a_mask_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "site.toml"
    file.write_text(HEAD + "privacy_masks = [{ pan_deg = [-60, 120], tilt_deg = [-90, 0] }]\n", encoding="utf-8")
    with pytest.raises(SiteError) as caught:
        build_views(load_site(file))
    (fault,) = caught.value.faults  # "ahead" still sees a cell to the far left, at pan -76
    assert fault.where == "cameras[0].presets[1]"
    assert 'preset "aside" of camera "a" that sees no free cell' in fault.found
    assert fault.expected.startswith("a clear view: ")
    assert "privacy_masks hide" in fault.expected


@pytest.mark.example
@pytest.mark.parametrize(
    ("mask", "where", "said"),
    [
        ("pan_deg = [10, -20], tilt_deg = [-60, -40]", "pan_deg", "found [10, -20]; expected pan rising"),
        ("pan_deg = [5, 5], tilt_deg = [-60, -40]", "pan_deg", "by more than 0 and at most 180 degrees"),
        ("pan_deg = [-180, 180], tilt_deg = [-60, -40]", "pan_deg", "two masks for more"),
        ("pan_deg = [-20, 10], tilt_deg = [-40, -60]", "tilt_deg", "expected the lower one first"),
    ],
)
def test_a_mask_the_wrong_way_round_is_refused(tmp_path: Path, mask: str, where: str, said: str) -> None:
    file = tmp_path / "site.toml"
    file.write_text(HEAD + f"privacy_masks = [{{ {mask} }}]\n", encoding="utf-8")
    with pytest.raises(SiteError) as caught:
        load_site(file)
    (fault,) = caught.value.faults
    assert fault.where == f"cameras[0].privacy_masks[0].{where}"
    assert said in str(fault)
