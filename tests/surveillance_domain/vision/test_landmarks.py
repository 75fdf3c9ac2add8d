"""Points of a calibration are found again, by marker or by what lies around them; what disagrees is left out."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.base import Position
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.calibration_file import (
    Calibrated,
    calibration_path,
    read_calibrations,
    write_calibrations,
)
from surveillance_domain.vision.drift import drifted
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.landmarks import Landmark, found_again, landmarks
from surveillance_domain.vision.point_files import PointsError
from surveillance_domain.vision.points import FloorMarker, FloorPoint, marked_points
from tests.known_points import CORNERS, lego_camera, points_of
from tests.pictured_targets import LAID_M, laid, pixels_of, preset_view

SITE = laid(load_site("lego"))
CAMERA = lego_camera()
MIDDLE = CAMERA.presets[1]
JOINTS = ((1.0, 1.0), (1.5, 1.0), (2.0, 1.0), (1.0, 1.5), (1.5, 1.5), (2.0, 1.5))
"""Where the joints of the emulated floor cross."""


def turned(pan_deg: float, tilt_deg: float = 0.0) -> np.ndarray:
    """What the camera shows at its middle preset when it looks beside it, with markers on the floor."""
    presets = (CAMERA.presets[0], MIDDLE.model_copy(update={"pan": pan_deg, "tilt": MIDDLE.tilt + tilt_deg}))
    view = preset_view(CAMERA.model_copy(update={"presets": presets}), "middle")
    return pixels_of(SITE, view, CORNERS, seed=round(10 * pan_deg + 100 * tilt_deg) % 7)


def joints() -> tuple[Landmark, ...]:
    return landmarks(points_of(CAMERA, "middle", JOINTS), {"middle": turned(0.0)})


@pytest.mark.example
@pytest.mark.parametrize(("pan", "tilt"), [(0.0, 0.0), (2.0, 0.0), (-1.5, 0.7)])
def test_a_turn_is_measured_from_joints_of_the_floor(pan: float, tilt: float) -> None:
    known = joints()
    assert len(known) == len(JOINTS)
    now = found_again(known, turned(pan, tilt), ())
    floor = ground(CAMERA, Position(MIDDLE.pan, MIDDLE.tilt, MIDDLE.zoom), (704, 576))
    drift = drifted(CAMERA, MIDDLE, floor, [one.point for one in known], now)
    assert (drift.of, drift.found) == (6, 6)
    assert drift.pan_deg == pytest.approx(pan, abs=0.1)
    assert drift.tilt_deg == pytest.approx(tilt, abs=0.1)
    # A turn by 2 degrees moves what is 1.3 to 2.2 m away by 4.5 to 7.7 cm.
    off = np.array(drift.residuals_m)
    assert off.max() < 0.01 if pan == 0 else 0.03 < off.mean() < 0.08


@pytest.mark.example
def test_markers_are_found_by_their_numbers_and_one_that_was_moved_is_left_out() -> None:
    assert SITE.markers is not None
    detector = MarkerDetector(SITE.markers)
    markers = {number: FloorMarker(number, place, LAID_M) for number, place in enumerate(CORNERS)}
    known = landmarks(marked_points("middle", detector.detect(turned(0.0)), markers), {})
    assert [one.point.marker for one in known] == list(range(6))
    assert all(one.patch is None for one in known)
    picture = turned(1.0)
    now = found_again(known, picture, detector.detect(picture))
    floor = ground(CAMERA, Position(MIDDLE.pan, MIDDLE.tilt, MIDDLE.zoom), (704, 576))
    before = [one.point for one in known]
    u, v = now[2].pixel  # type: ignore[union-attr]
    kicked = [*now[:2], replace(before[2], pixel=(u - 70.0, v + 30.0)), *now[3:5], None]
    drift = drifted(CAMERA, MIDDLE, floor, before, kicked)
    assert (drift.of, drift.found) == (6, 4)
    assert drift.pan_deg == pytest.approx(1.0, abs=0.1)
    nothing = drifted(CAMERA, MIDDLE, floor, before, [None] * 6)
    assert (nothing.of, nothing.found, nothing.residuals_m) == (6, 0, ())


@pytest.mark.example
def test_what_cannot_be_found_again_is_not_kept() -> None:
    plain = np.full((576, 704, 3), 120, dtype=np.uint8)
    inside = FloorPoint("a", "middle", (300.0, 300.0), (1.0, 1.0))
    assert landmarks([inside], {"middle": plain}) == ()
    assert landmarks([inside], {}) == ()
    textured = np.random.default_rng(0).integers(0, 255, plain.shape).astype(np.uint8)
    at_edge = replace(inside, pixel=(5.0, 300.0))
    kept = landmarks([inside, at_edge], {"middle": textured})
    assert [one.point for one in kept] == [inside]
    assert found_again(kept, plain, ()) == (None,)
    (again,) = found_again(kept, np.roll(textured, (7, -4), axis=(0, 1)), ())
    assert again is not None
    assert again.pixel == (296.0, 307.0)


@pytest.mark.example
def test_calibrations_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = calibration_path(tmp_path / "site.toml")
    assert path == tmp_path / "site.calibration.json"
    assert read_calibrations(path) == {}
    marked, known = Landmark(FloorPoint("marker 3", "left", (1.5, 2.5), (0.5, 0.25), 0.1, 3)), joints()
    write_calibrations(path, "south", [Calibrated(MIDDLE, "2026-01-31T12:00:00+00:00", 0.01, known)], anew=False)
    left = Calibrated(CAMERA.presets[0], "2026-02-01T12:00:00+00:00", 0.02, (marked,))
    write_calibrations(path, "south", [left], anew=False)
    found = read_calibrations(path)["south"]
    assert list(found) == ["middle", "left"]
    assert found["left"].landmarks[0].point == marked.point
    assert (found["left"].when, found["left"].residual_m) == (left.when, 0.02)
    for one, was in zip(found["middle"].landmarks, known, strict=True):
        assert one.point == was.point
        np.testing.assert_array_equal(one.patch, was.patch)
    write_calibrations(path, "south", [left], anew=True)
    write_calibrations(path, "north", [left], anew=False)
    assert {camera: list(own) for camera, own in read_calibrations(path).items()} == {
        "south": ["left"],
        "north": ["left"],
    }
    assert [file.name for file in tmp_path.iterdir()] == [path.name]


@pytest.mark.example
@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda text: text[:-20], "no calibrations"),
        (lambda text: text.replace('"u": 1.5', '"u": "wide"'), "cameras[0].presets[0].points[0].u"),
        (lambda text: text.replace('"marker": 3', '"patch": "not a picture"'), "points[0].patch"),
    ],
)
def test_a_file_of_others_is_refused(tmp_path: Path, change: object, said: str) -> None:
    path = tmp_path / "site.calibration.json"
    marked = Landmark(FloorPoint("marker 3", "left", (1.5, 2.5), (0.5, 0.25), 0.1, 3))
    write_calibrations(path, "south", [Calibrated(CAMERA.presets[0], "2026-02-01", 0.02, (marked,))], anew=False)
    assert json.loads(path.read_text())["schema_version"] == 1
    path.write_text(change(path.read_text()))  # type: ignore[operator]
    with pytest.raises(PointsError, match=r"site\.calibration\.json") as refused:
        read_calibrations(path)
    assert said in str(refused.value)
