"""The doctor names each fault and its mend; every fault is really there, in an emulated camera or in the site."""

from __future__ import annotations

import socket
import ssl
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.emulation import wording
from surveillance_domain.emulation.site import PASSWORD, EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.emulation.virtual_session import virtual_session
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.model.views import Views, build_views
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.vision.points import FloorMarker
from surveillance_domain.world.doctor import Check, Examination

LEGO = load_site("lego")
ONE = replace(LEGO, cameras=LEGO.cameras[:1])
VIEWS = build_views(ONE)


@contextmanager
def emulated() -> Iterator[EmulatedSite]:
    with EmulatedSite(ONE, 2, VirtualClock(), np.random.default_rng(0), smooth=False) as emulation:
        yield emulation


def examined(
    emulation: EmulatedSite,
    password: str = PASSWORD,
    held: bool = False,
    site: Mapping[str, Any] | None = None,
    **changes: Any,
) -> dict[str, Check]:
    """Checks of the emulated camera by their names, with changes to what the site says of it."""
    described = emulation.site.cameras[0].model_copy(update=changes)
    found = replace(emulation.site, cameras=(described,), **(site or {}))
    clock = emulation._clock
    camera = open_camera(described, clock, np.random.default_rng(1), session=virtual_session(), password=password)
    try:
        examination = Examination(found, _views(found), clock, today=lambda: datetime.now(UTC))
        return {check.name: check for check in examination.of(camera, held)}
    finally:
        camera.close()


def _views(site: Site) -> Views:
    try:
        return build_views(site)
    except ValueError:
        return VIEWS


@pytest.mark.end_to_end
def test_a_healthy_camera_is_turned_and_put_back() -> None:
    with emulated() as emulation:
        before = emulation.cameras["south"].motors.true()
        found = examined(emulation)
        assert emulation.cameras["south"].motors.true() == before
        assert list(found) == [
            "reachability", "authentication", "limits", "snapshot", "resolution",
            "markers", "other masters", "clock", "move",
        ]  # fmt: skip
        assert all(check.ok for check in found.values())
        assert found["move"].detail == 'to "middle" in 0.70 s, settled, and back'
        assert found["resolution"].detail == "704 x 576"
        emulation.cameras["south"].motors.command = pytest.fail  # type: ignore[method-assign]
        assert "move" not in examined(emulation, held=True)


@pytest.mark.end_to_end
def test_wrong_password() -> None:
    with emulated() as emulation:
        found = examined(emulation, password="wrong")
        assert list(found) == ["reachability", "authentication"]
        assert found["reachability"].ok
        assert not found["authentication"].ok
        assert "refuses user 'operator'" in found["authentication"].detail
        assert "put the password of username into the environment variable" in found["authentication"].detail


@pytest.mark.end_to_end
def test_wrong_port() -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with emulated() as emulation:
        (check,) = examined(emulation, url=f"http://127.0.0.1:{port}").values()
        assert (check.name, check.ok) == ("reachability", False)
        assert "Connection refused" in check.detail
        assert "are address and port in url those of its web page?" in check.detail


@pytest.mark.end_to_end
def test_https_to_a_camera_that_speaks_none() -> None:
    with emulated() as emulation:
        url = emulation.servers["south"].url.replace("http:", "https:")
        (check,) = examined(emulation, url=url).values()
        assert (check.name, check.ok) == ("reachability", False)
        assert f"it speaks http at this port: set url = {emulation.servers['south'].url!r}" in check.detail


@contextmanager
def tls_port() -> Iterator[int]:
    """A server that greets only those who speak TLS; its certificate is made here."""
    import subprocess
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as name:
        key, certificate = Path(name) / "key.pem", Path(name) / "certificate.pem"
        words = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=camera"]
        subprocess.run([*words, "-keyout", key, "-out", certificate], check=True, capture_output=True)
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(certificate, key)
    listener = socket.create_server(("127.0.0.1", 0))

    def serve() -> None:
        while True:
            try:
                connection, _ = listener.accept()
                with context.wrap_socket(connection, server_side=True):
                    pass
            except OSError:
                if listener.fileno() < 0:
                    return

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    port = listener.getsockname()[1]
    try:
        yield port
    finally:
        listener.shutdown(socket.SHUT_RDWR)
        listener.close()
        thread.join()


@pytest.mark.end_to_end
def test_http_to_a_camera_that_wants_tls() -> None:
    import shutil

    if shutil.which("openssl") is None:
        pytest.skip("openssl, which makes the certificate, is not installed")
    with emulated() as emulation, tls_port() as port:
        (check,) = examined(emulation, url=f"http://127.0.0.1:{port}").values()
        assert not check.ok
        assert f"it speaks https at this port: set url = 'https://127.0.0.1:{port}'" in check.detail
        (check,) = examined(emulation, url=f"https://127.0.0.1:{port}").values()
        assert not check.ok
        assert "give the certificate that signed the camera's as ca_file" in check.detail


@pytest.mark.end_to_end
def test_preset_outside_limits() -> None:
    presets = list(ONE.cameras[0].presets)
    presets[2] = presets[2].model_copy(update={"pan": 175.0})
    with emulated() as emulation:
        found = examined(emulation, presets=tuple(presets))
        assert not found["limits"].ok
        assert '"right": pan 175 is outside -170 to 170' in found["limits"].detail
        assert "surveillance add-preset" in found["limits"].detail
        assert found["snapshot"].ok  # the rest is looked at all the same


@pytest.mark.end_to_end
def test_picture_too_small_for_the_markers() -> None:
    with emulated() as emulation:
        small = ONE.cameras[0].image.model_copy(update={"width": 352, "height": 288})
        found = examined(emulation, image=small, required_px_per_m=100.0)
        assert not found["markers"].ok
        assert '16 px at the far edge of "left"' in found["markers"].detail
        assert "24 are needed: zoom in, use markers of 0.1" in found["markers"].detail


@pytest.mark.end_to_end
def test_pictures_of_another_size_and_no_pictures() -> None:
    with emulated() as emulation:
        honest = emulation.cameras["south"]._snapshot
        emulation.cameras["south"]._snapshot = lambda size, compression: honest((352, 288), compression)
        found = examined(emulation)
        assert "pictures are 352 x 288, the site says 704 x 576: set image" in found["resolution"].detail
        emulation.cameras["south"].faults.garbled_picture = True
        found = examined(emulation)
        assert not found["snapshot"].ok
        assert "resolution" not in found


@pytest.mark.end_to_end
@pytest.mark.parametrize(("shift_m", "ok"), [(0.0, True), (0.1, True), (0.3, False)])
def test_homography_off(shift_m: float, ok: bool) -> None:
    camera = ONE.cameras[0]
    view = pinhole(camera, camera.presets[0].pan, camera.presets[0].tilt, 1.0)
    homography = np.array([[1, 0, shift_m], [0, 1, 0], [0, 0, 1]]) @ view.homography()
    rows = tuple(tuple(row) for row in homography.tolist())
    presets = (camera.presets[0].model_copy(update={"homography": rows}), *camera.presets[1:])
    with emulated() as emulation:
        check = examined(emulation, presets=presets)["calibration"]
        assert check.ok is ok
        assert f'differ by up to {shift_m:.2f} m on the floor (preset "left")' in check.detail
        assert ok or "run surveillance calibrate again" in check.detail


@pytest.mark.end_to_end
@pytest.mark.parametrize(("shift_m", "ok"), [(0.0, True), (0.3, False)])
def test_markers_that_lie_where_they_should(shift_m: float, ok: bool) -> None:
    with emulated() as emulation:
        described = emulation.site.cameras[0]
        for _ in range(40):  # until a robot is in view
            emulation._clock.sleep(1.5)
            places = emulation.truth.positions_m
            markers = {k: FloorMarker(k, (x + shift_m, y), 0.10) for k, (x, y) in enumerate(places.tolist())}
            camera = open_camera(
                described, emulation._clock, np.random.default_rng(1), session=virtual_session(), password=PASSWORD
            )
            found = Examination(emulation.site, VIEWS, emulation._clock, False, markers).of(camera)
            camera.close()
            (check,) = [one for one in found if one.name == "known markers"]
            if "none of the markers" not in check.detail:
                break
        assert check.ok is ok
        assert ("markers seen 0.3" in check.detail) is not ok


@pytest.mark.end_to_end
def test_guard_tours_queues_and_clocks(monkeypatch: pytest.MonkeyPatch) -> None:
    with emulated() as emulation:
        monkeypatch.setitem(wording._PARAMETERS, "root.PTZ.Various.V1.CtlQueueing", "true")
        monkeypatch.setitem(wording._PARAMETERS, "root.PTZ.Various.V1.ReturnToOverview", "30")
        monkeypatch.setitem(wording._PARAMETERS, "root.GuardTour.G0.Running", "yes")
        told = examined(emulation)["other masters"]
        assert not told.ok
        for part in (
            "a guard tour runs",
            "a control queue is on",
            "returns to its overview after 30 s",
            "set that to 0",
        ):
            assert part in told.detail
        camera = emulation.open_cameras(np.random.default_rng(0))[0]
        later = datetime.now(UTC) + timedelta(minutes=5)
        found = Examination(ONE, VIEWS, emulation._clock, False, today=lambda: later).of(camera)
        camera.close()
        (clock,) = [one for one in found if one.name == "clock"]
        assert not clock.ok
        assert "300 s behind this machine's: give both the same time server" in clock.detail.replace("301", "300")


@pytest.mark.end_to_end
def test_a_camera_that_does_not_do_as_it_is_told() -> None:
    with emulated() as emulation:
        emulation.cameras["south"].faults.frozen = True
        emulation.cameras["south"].motors.told()
        move = examined(emulation)["move"]
        assert not move.ok
        assert "stalled" in move.detail
        assert "sent back, it tells pan -40, tilt -40" in move.detail
        emulation._clock.sleep(1.0)
        assert emulation.cameras["south"].motors.true()[:2] == (-40.0, -40.0)  # where it stood, not where it was sent


@pytest.mark.end_to_end
def test_a_picture_that_breaks_off_is_no_fault_of_limits_or_address() -> None:
    with emulated() as emulation:
        emulation.cameras["south"].faults.truncated_picture = True
        checks = examined(emulation)
        assert checks["reachability"].ok
        assert checks["limits"].ok
        assert not checks["snapshot"].ok
        assert "broke off after" in checks["snapshot"].detail
        assert "restart the camera" in checks["snapshot"].detail
        assert "address" not in checks["snapshot"].detail


@pytest.mark.end_to_end
def test_a_camera_that_has_too_much_to_do_is_there() -> None:
    with emulated() as emulation:
        emulation.cameras["south"].faults.unavailable_share = 1.0
        found = examined(emulation)["reachability"]
        assert (found.ok, "answers 503" in found.detail, "wait a minute" in found.detail) == (False, True, True)
        assert "is it switched on" not in found.detail
