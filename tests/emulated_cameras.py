"""An emulated camera and its driver on one virtual clock; and a server that sends bytes just as they are given."""

from __future__ import annotations

import socket
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np

from surveillance_domain.cameras.base import Limits, Position
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.emulation.camera import EmulatedCamera
from surveillance_domain.emulation.guard import Guard
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.server import CameraServer
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.emulation.virtual_session import virtual_session
from surveillance_domain.site.camera import Camera as CameraDescription

__all__ = ["PASSWORD", "Pair", "described", "emulated_pair", "jpeg", "raw_server"]

PASSWORD = "pa55-wörd"
LIMITS = Limits((-170.0, 170.0), (-90.0, 30.0), (1.0, 9999.0))


def described(url: str | None, **changes: Any) -> CameraDescription:
    """A camera that turns 100 degrees a second and settles in 0.3 s; two presets, 40 degrees apart."""
    table = {
        "name": "north",
        "mount": {"position_m": (0.0, 0.0, 2.0)},
        "presets": [
            {"name": "left", "pan": -20.0, "tilt": -40.0, "zoom": 1.0},
            {"name": "right", "pan": 20.0, "tilt": -40.0, "zoom": 1.0},
        ],
        "zoom_hfov": [(1.0, 48.0), (9999.0, 2.7)],
        "image": {"width": 64, "height": 48},
        "max_depth_m": 5.0,
        "pan_deg_per_s": 100.0,
        "tilt_deg_per_s": 100.0,
        "settle_s": 0.3,
        "url": url,
        "username": "operator",
    }
    return CameraDescription.model_validate({**table, **changes})


def jpeg(width: int = 64, height: int = 48, quality: int = 75) -> bytes:
    """A small picture."""
    from PIL import Image

    pixels = np.add.outer(np.arange(height) * 2, np.arange(width)).astype(np.uint8)
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, format="JPEG", quality=quality)
    return buffer.getvalue()


@dataclass
class Pair:
    """A camera and its driver."""

    clock: VirtualClock
    camera: EmulatedCamera
    server: CameraServer
    driver: VapixCamera

    @property
    def left(self) -> Position:
        return Position(-20.0, -40.0, 1.0)

    @property
    def right(self) -> Position:
        return Position(20.0, -40.0, 1.0)


@contextmanager
def emulated_pair(
    offers: Sequence[str] = ("MD5",), limits: Limits = LIMITS, nonce_s: float = 3600.0, **changes: Any
) -> Iterator[Pair]:
    """A camera that looks to its left preset, with grey pictures, and its driver."""
    clock = VirtualClock()
    rng = np.random.default_rng(0)
    motors = EmulatedMotors((-20.0, -40.0, 1.0), limits, (100.0, 100.0, np.inf), clock)
    guard = Guard("AXIS_ACCC8E000001", "operator", PASSWORD, clock, rng, offers, nonce_s)
    camera = EmulatedCamera(motors, guard, lambda size, compression: jpeg(*size), (64, 48), (), clock, rng)
    server = CameraServer(camera)
    password = changes.pop("password", PASSWORD)
    description = described(changes.pop("url", server.url), **changes)
    session = virtual_session()
    driver = open_camera(description, clock, np.random.default_rng(1), session=session, password=password)
    try:
        yield Pair(clock, camera, server, driver)
    finally:
        driver.close()
        server.close()


@contextmanager
def raw_server(*answers: bytes, slowly_s: float | None = None) -> Iterator[str]:
    """The address of a server that sends one of the answers to each connection in turn, the last one from then on.

    With ``slowly_s`` it sends byte by byte, with that pause between.
    """
    listener = socket.create_server(("127.0.0.1", 0))
    stop = threading.Event()

    def serve() -> None:
        count = 0
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            with connection:
                if stop.is_set():
                    return
                _speak(connection, answers[min(count, len(answers) - 1)], slowly_s, stop)
                count += 1

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        stop.set()
        with socket.create_connection(listener.getsockname()):
            pass
        thread.join()
        listener.close()


def _speak(connection: socket.socket, answer: bytes, slowly_s: float | None, stop: threading.Event) -> None:
    try:
        connection.settimeout(5)
        connection.recv(65_536)
        if slowly_s is None:
            connection.sendall(answer)
        else:
            for byte in answer:
                connection.sendall(bytes([byte]))
                if stop.wait(slowly_s):
                    return
        connection.shutdown(socket.SHUT_RDWR)
    except OSError:
        return
