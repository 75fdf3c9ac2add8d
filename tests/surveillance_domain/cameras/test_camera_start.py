"""Getting to know a camera, and its pictures."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from surveillance_domain.cameras.base import Camera, Limits
from surveillance_domain.cameras.clock import RealClock
from surveillance_domain.cameras.errors import BadPicture, BrokeOff, CameraError, OutsideLimits, Refused
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.emulation.wording import error_text
from tests.emulated_cameras import LIMITS, described, emulated_pair, jpeg


@pytest.mark.end_to_end
def test_start_reads_limits_and_the_size_of_pictures() -> None:
    with emulated_pair() as pair:
        assert isinstance(pair.driver, Camera)
        assert pair.driver.start(5.0) == LIMITS
        assert pair.driver.picture_size == (64, 48)
        assert pair.driver.image_size(1.0) == (64, 48)
        assert pair.driver.parameters("PTZ", 1.0)["root.PTZ.Limit.L1.MaxPan"] == "170"
        assert "speeds" in pair.driver.attributes(1.0)


@pytest.mark.end_to_end
def test_presets_outside_the_limits_are_refused_by_name() -> None:
    with emulated_pair(limits=Limits((-10.0, 10.0), (-30.0, 90.0), (1.0, 9999.0))) as pair:
        with pytest.raises(OutsideLimits) as caught:
            pair.driver.start(5.0)
        assert str(caught.value) == (
            'north: presets that the camera would clamp: "left": pan -20 is outside -10 to 10; "left": tilt -40 is '
            'outside -30 to 90; "right": pan 20 is outside -10 to 10; "right": tilt -40 is outside -30 to 90'
        )


@pytest.mark.end_to_end
def test_a_size_that_the_camera_does_not_know_is_left_to_it() -> None:
    with emulated_pair(image={"width": 5000, "height": 48}) as pair:
        pair.driver.start(5.0)
        assert pair.driver.picture_size == (64, 48)
        assert pair.driver.picture(2.0).width == 64


@pytest.mark.end_to_end
def test_another_channel_is_not_there() -> None:
    with emulated_pair(channel=2) as pair, pytest.raises(Refused, match="Camera 2 not available"):
        pair.driver.start(5.0)


@pytest.mark.end_to_end
def test_a_picture_that_is_taken_in_a_move_does_not_count() -> None:
    with emulated_pair() as pair:
        picture = pair.driver.picture(2.0)
        assert (picture.width, picture.height) == (64, 48)
        assert picture.position == pair.left
        assert picture.jpeg == jpeg()

        def while_turning(size: tuple[int, int], compression: int) -> bytes:
            pair.camera.motors.command({"pan": "100"})
            pair.clock.sleep(0.5)
            return jpeg(*size)

        pair.camera._snapshot = while_turning
        with pytest.raises(BadPicture, match="north: it moved"):
            pair.driver.picture(2.0)


@pytest.mark.end_to_end
def test_pictures_that_are_none() -> None:
    with emulated_pair() as pair:
        pair.driver.start(5.0)
        pair.camera.faults.garbled_picture = True
        with pytest.raises(BadPicture, match=r"north: no JPEG: .* bytes that begin with"):
            pair.driver.picture(2.0)
        pair.camera.faults.garbled_picture = False
        pair.camera.faults.truncated_picture = True
        with pytest.raises(BrokeOff, match="broke off after"):
            pair.driver.picture(2.0)
        pair.camera.faults.truncated_picture = False
        pair.camera._snapshot = lambda size, compression: jpeg(*size)[:-200]
        with pytest.raises(BadPicture, match="cannot be decoded"):
            pair.driver.picture(2.0)
        pair.camera._snapshot = lambda size, compression: error_text("camera", "1").encode()
        with pytest.raises(Refused, match="unknown value: 1"):
            pair.driver.picture(2.0)
        assert pair.driver.health.failures == 1  # a picture that was answered is no failure to answer


def driver(**changes: object) -> VapixCamera:
    return open_camera(described("http://127.0.0.1:1", **changes), RealClock(), np.random.default_rng(0))


@pytest.mark.example
def test_the_password_comes_from_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("CAM_NORTH_PASSWORD", raising=False)
    with pytest.raises(CameraError, match="north: set CAM_NORTH_PASSWORD"):
        driver(password_env="CAM_NORTH_PASSWORD")
    monkeypatch.setenv("CAM_NORTH_PASSWORD", "")
    with pytest.raises(
        CameraError, match="north: set CAM_NORTH_PASSWORD, the variable of its password, which is empty"
    ):
        driver(password_env="CAM_NORTH_PASSWORD")
    monkeypatch.setenv("CAM_NORTH_PASSWORD", "hush")
    assert "hush" not in repr(driver(password_env="CAM_NORTH_PASSWORD"))


@pytest.mark.example
def test_no_address() -> None:
    with pytest.raises(CameraError, match="north: no url; give the camera's address"):
        open_camera(described(None), RealClock(), np.random.default_rng(0))


@pytest.mark.example
def test_the_environment_and_netrc_are_not_asked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HTTP_PROXY", "http://127.0.0.1:9")
    netrc = tmp_path / "netrc"
    netrc.write_text("machine 127.0.0.1 login operator password other\n")
    monkeypatch.setenv("NETRC", str(netrc))
    with emulated_pair() as pair:
        assert pair.driver.position(1.0) == pair.left
