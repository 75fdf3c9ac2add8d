"""A whole emulated site, as the network of cameras meets it."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from surveillance_domain.cameras.base import Move, Outcome, Picture, Position
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.load import load_site

cv2 = pytest.importorskip("cv2")

from surveillance_domain.emulation.site import EmulatedSite, emulated_limits  # noqa: E402

LEGO = load_site("lego")


def turn_and_look(camera: VapixCamera, preset: int) -> Callable[[], tuple[Move, Picture | None]]:
    chosen = camera.description.presets[preset]

    def task() -> tuple[Move, Picture | None]:
        move = camera.move(Position(chosen.pan, chosen.tilt, float(chosen.zoom)), 1.5)
        return move, camera.picture(0.4) if move.outcome is Outcome.REACHED else None

    return task


@pytest.mark.end_to_end
def test_cameras_turn_together_and_pictures_show_the_truth() -> None:
    clock = VirtualClock()
    rng = np.random.default_rng(3)
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    found = 0
    with (
        EmulatedSite(LEGO, 3, clock, np.random.default_rng(1), smooth=False) as emulated,
        ThreadPoolExecutor(3) as pool,
    ):
        cameras = emulated.open_cameras(rng)
        for camera in cameras:
            camera.start(10.0)
        for step in range(8):
            began = clock.now()
            futures = clock.together(pool, [turn_and_look(camera, int(rng.integers(3))) for camera in cameras])
            assert clock.now() - began == pytest.approx(max(future.result()[0].seconds for future in futures))
            for camera, future in zip(cameras, futures, strict=True):
                move, picture = future.result()
                assert move.outcome is Outcome.REACHED
                assert picture is not None
                position = picture.position
                hole = pinhole(camera.description, position.pan, position.tilt, position.zoom or 1.0)
                corners, numbers, _ = detector.detectMarkers(
                    cv2.imdecode(np.frombuffer(picture.jpeg, np.uint8), cv2.IMREAD_COLOR)
                )
                for marker, four in zip([] if numbers is None else numbers.ravel(), corners, strict=True):
                    place = hole.on_plane(four[0].astype(float), 0.10).mean(axis=0)
                    np.testing.assert_allclose(place, emulated.truth.positions_m[marker], atol=0.03)
                    found += 1
            clock.sleep(1.5 * (step + 1) - clock.now())
        assert found > 5
        assert [camera.guard.refusals for camera in emulated.cameras.values() if camera.guard] == [1, 1, 1]
        assert [server.connections for server in emulated.servers.values()] == [2, 2, 2]
        for camera in cameras:
            camera.close()


@pytest.mark.end_to_end
def test_one_sick_camera_does_not_hold_up_the_others() -> None:
    clock = VirtualClock()
    with EmulatedSite(LEGO, 1, clock, np.random.default_rng(1)) as emulated, ThreadPoolExecutor(3) as pool:
        cameras = emulated.open_cameras(np.random.default_rng(2))
        for camera in cameras:
            camera.start(10.0)
        emulated.cameras["north-west"].faults.latency_s = 30.0
        for preset in (1, 2, 0) * 2:
            began = clock.now()
            futures = clock.together(pool, [turn_and_look(camera, preset) for camera in cameras])
            outcomes = [future.result()[0].outcome for future in futures]
            assert outcomes == [Outcome.REACHED, Outcome.UNREACHABLE, Outcome.REACHED]
            assert clock.now() - began <= 1.5 + 1e-9
            clock.sleep(1.5)
        for camera in cameras:
            camera.close()


@pytest.mark.end_to_end
def test_same_seed_same_motion_and_the_site_says_where_its_cameras_are() -> None:
    places = []
    for _ in range(2):
        clock = VirtualClock()
        with EmulatedSite(LEGO, 2, clock, np.random.default_rng(5), truth="grid") as emulated:
            clock.sleep(30.0)
            places.append(emulated.truth.positions_m)
            assert [camera.url for camera in emulated.site.cameras] == [s.url for s in emulated.servers.values()]
            assert all(camera.username == "operator" for camera in emulated.site.cameras)
            assert list(emulated.cameras) == ["south", "north-west", "north-east"]
    np.testing.assert_array_equal(*places)


@pytest.mark.example
def test_limits_are_those_of_an_axis_214_widened_where_presets_need_it() -> None:
    standing = LEGO.cameras[0]
    assert emulated_limits(standing).tilt == (-90.0, 30.0)
    hanging = standing.model_copy(update={"mount": standing.mount.model_copy(update={"inverted": True})})
    assert emulated_limits(hanging).tilt == (-40.0, 90.0)  # a preset looks to -40
    assert emulated_limits(hanging).pan == (-170.0, 170.0)
