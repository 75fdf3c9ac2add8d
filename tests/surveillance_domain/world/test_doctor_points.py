"""The doctor looks for the points that a camera was calibrated from, and says by how much it looks beside."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.base import Position
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.emulation.site import PASSWORD, EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.emulation.virtual_session import virtual_session
from surveillance_domain.model.views import build_views
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.calibration_file import Calibrated
from surveillance_domain.vision.landmarks import landmarks
from surveillance_domain.vision.opencv import decoded
from surveillance_domain.vision.points import FloorMarker, marked_points
from surveillance_domain.world.doctor import Check, Examination

LEGO = load_site("lego")
ONE = replace(LEGO, cameras=LEGO.cameras[:1])
VIEWS = build_views(ONE)
CHECK = "calibration points"
LAID = {
    number: FloorMarker(number, place, 0.001)
    for number, place in enumerate(((0.9, 1.0), (2.1, 1.0), (1.0, 1.9), (2.0, 1.9), (1.5, 1.4), (0.4, 1.2)), 30)
}


@contextmanager
def emulated(laid: bool = True) -> Iterator[EmulatedSite]:
    sheets = tuple(LAID.values()) if laid else ()
    with EmulatedSite(ONE, 1, VirtualClock(), np.random.default_rng(0), laid=sheets) as emulation:
        yield emulation


def calibrated(emulation: EmulatedSite) -> dict[str, Calibrated]:
    """What calibrate would keep of the middle and the left preset."""
    assert ONE.markers is not None
    detector, found = MarkerDetector(ONE.markers), {}
    (camera,) = emulation.open_cameras(np.random.default_rng(0))
    for preset in camera.description.presets[:2]:
        camera.move(Position(preset.pan, preset.tilt, preset.zoom), 5.0)
        points = marked_points(preset.name, detector.detect(decoded(camera.picture(2.0).jpeg)), LAID)
        found[preset.name] = Calibrated(preset, "2026-01-31T12:00:00+00:00", 0.004, landmarks(points, {}))
    camera.close()
    return found


def examined(
    emulation: EmulatedSite, known: Mapping[str, Calibrated], moves: bool = True, at: int = 0
) -> dict[str, Check]:
    described = emulation.site.cameras[0]
    clock = emulation._clock
    camera = open_camera(described, clock, np.random.default_rng(1), session=virtual_session(), password=PASSWORD)
    try:
        preset = described.presets[at]
        camera.move(Position(preset.pan, preset.tilt, preset.zoom), 5.0)
        doctor = Examination(emulation.site, VIEWS, clock, moves, calibrated={camera.name: known})
        return {check.name: check for check in doctor.of(camera)}
    finally:
        camera.close()


@pytest.mark.end_to_end
def test_points_that_lie_where_they_lay() -> None:
    with emulated() as emulation:
        known = calibrated(emulation)
        told = sum(len(one.landmarks) for one in known.values())
        assert told >= 6
        emulation.cameras["south"].motors.command({"pan": "13"})
        check = examined(emulation, known)[CHECK]
        assert check.ok
        assert f"{told} of {told} points found again at left, middle, 0.00" in check.detail
        assert "0.004 m when calibrated (2026-01-31T12:00:00+00:00)" in check.detail
        assert "beside" not in check.detail
        assert emulation.cameras["south"].motors.true()[0] == -40.0  # back where it was


@pytest.mark.end_to_end
@pytest.mark.parametrize(("slip_deg", "ok"), [(1.0, True), (8.0, False)])
def test_a_pan_that_slipped_is_measured(slip_deg: float, ok: bool) -> None:
    with emulated() as emulation:
        known = calibrated(emulation)
        emulation.cameras["south"].faults.pan_slip_deg = slip_deg
        found = examined(emulation, known)
        check = found[CHECK]
        assert found["move"].ok  # its own numbers are right
        assert check.ok is ok
        assert f"it looks {slip_deg:+.1f}° in pan beside what it says" in check.detail
        assert ok or "more than half a cell: restart it" in check.detail
        assert ok or "run surveillance calibrate again" in check.detail


@pytest.mark.end_to_end
def test_without_turning_only_what_it_looks_at_is_compared() -> None:
    with emulated() as emulation:
        known = calibrated(emulation)
        emulation.cameras["south"].faults.pan_slip_deg = 8.0
        check = examined(emulation, known, moves=False, at=1)[CHECK]
        assert not check.ok
        assert "again at middle," in check.detail
        check = examined(emulation, known, moves=False, at=2)[CHECK]
        assert check.ok
        assert "not looked for: it stands at none of the presets that were calibrated" in check.detail


@pytest.mark.end_to_end
def test_points_that_are_gone_and_presets_that_were_changed() -> None:
    with emulated() as emulation:
        known = calibrated(emulation)
    with emulated(laid=False) as emulation:
        check = examined(emulation, known)[CHECK]
        assert check.ok
        assert "not checked: 0 of" in check.detail
        assert "lay the markers out again" in check.detail
        left = known["left"]
        known["left"] = replace(left, preset=left.preset.model_copy(update={"pan": -35.0}))
        check = examined(emulation, known)[CHECK]
        assert not check.ok
        assert "turned elsewhere since they were calibrated: left; run surveillance calibrate again" in check.detail
