"""An emulated AXIS camera: what it answers to every question, and what its faults make of it. No HTTP here."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus

import numpy as np

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.emulation import wording
from surveillance_domain.emulation.faults import Faults
from surveillance_domain.emulation.guard import Guard
from surveillance_domain.emulation.motors import EmulatedMotors

__all__ = ["EmulatedCamera", "Question", "Reply"]

_MOVES = ("pan", "tilt", "zoom", "rpan", "rtilt", "rzoom", "move")
_MOST_SIDE = 4096


@dataclass(frozen=True)
class Question:
    """A GET.

    Attributes
    ----------
    target : str
        Path and query, as asked.
    path : str
    query : dict
        The last value of each key.
    authorization : str or None
        The header.
    patience_s : float or None
        After how long the client hangs up, where it says so (only in virtual time).
    """

    target: str
    path: str
    query: Mapping[str, str]
    authorization: str | None = None
    patience_s: float | None = None


@dataclass(frozen=True)
class Reply:
    """What goes back.

    Attributes
    ----------
    status : HTTPStatus
    body : bytes
    content_type : str
    headers : list of (str, str)
    cut_at : int or None
        After so many bytes of the body the connection is closed.
    """

    status: HTTPStatus
    body: bytes = b""
    content_type: str = "text/plain"
    headers: list[tuple[str, str]] = field(default_factory=list)
    cut_at: int | None = None


class EmulatedCamera:
    """Answers questions.

    Parameters
    ----------
    motors : EmulatedMotors
    guard : Guard or None
        ``None``: everybody is let in.
    snapshot : callable
        ``snapshot((width, height), compression)``: a JPEG of what it sees now.
    size : (int, int)
        Width and height of its pictures, in pixels.
    zoom_magnification : tuple of (zoom, magnification)
        For ``query=attributes``.
    clock : Clock
    rng : numpy.random.Generator
        For faults that happen to a share of questions.
    channel : int
        The one that is there.
    """

    def __init__(
        self,
        motors: EmulatedMotors,
        guard: Guard | None,
        snapshot: Callable[[tuple[int, int], int], bytes],
        size: tuple[int, int],
        zoom_magnification: tuple[tuple[float, float], ...],
        clock: Clock,
        rng: np.random.Generator,
        channel: int = 1,
    ) -> None:
        self.motors, self.guard, self.size = motors, guard, size
        self._snapshot, self._zoom_magnification = snapshot, zoom_magnification
        self._clock, self._rng, self._channel = clock, rng, channel
        self._lock = threading.Lock()
        self.questions = 0

    @property
    def faults(self) -> Faults:
        """What is wrong with it; change it at will."""
        return self.motors.faults

    def reboot(self) -> None:
        """Break off what it does, be gone for a while, and come back looking straight ahead."""
        self.motors.reboot()

    def reply(self, question: Question) -> Reply | None:
        """The answer; ``None``: the connection is closed without one."""
        self.questions += 1
        if not self._in_time(question) or not self.motors.awake():
            return None
        with self._lock:
            luck = self._rng.random(2)
        if luck[0] < self.faults.drop_share:
            return None
        if luck[1] < self.faults.unavailable_share:
            return Reply(HTTPStatus.SERVICE_UNAVAILABLE, b"Service Unavailable\n")
        challenges = self._challenges(question)
        if challenges is not None:
            headers = [("WWW-Authenticate", challenge) for challenge in challenges]
            body = b"<HTML><HEAD><TITLE>401 Unauthorized</TITLE></HEAD><BODY>Unauthorized</BODY></HTML>\n"
            return Reply(HTTPStatus.UNAUTHORIZED, body, "text/html", [*headers, ("Connection", "close")])
        return self._answer(question)

    def _in_time(self, question: Question) -> bool:
        """Let the latency pass; in virtual time the client hangs up when its own time is over."""
        latency_s = self.faults.latency_s
        patience_s = question.patience_s
        gone = patience_s is not None and latency_s >= patience_s
        self._clock.sleep(patience_s if gone and patience_s is not None else latency_s)
        return not gone

    def _challenges(self, question: Question) -> list[str] | None:
        if self.guard is None:
            return None
        if self.motors.rebooted():
            self.guard.forget()
        authorization = None if self.faults.wrong_password else question.authorization
        return self.guard.refuses("GET", question.target, authorization)

    def _answer(self, question: Question) -> Reply:
        query = question.query
        if query.get("camera", str(self._channel)) != str(self._channel):
            return _text(wording.CHANNEL_MISSING.format(channel=query["camera"]))
        if question.path == "/axis-cgi/com/ptz.cgi":
            return self._ptz(query)
        if question.path in ("/axis-cgi/jpg/image.cgi", "/jpg/image.jpg"):
            return self._picture(query)
        if question.path == "/axis-cgi/imagesize.cgi":
            return _text(f"image width = {self.size[0]}\r\nimage height = {self.size[1]}\r\n")
        if question.path == "/axis-cgi/param.cgi" and query.get("action", "list") == "list":
            return _text(wording.parameters_text(query.get("group", "root"), self.motors.limits))
        return Reply(HTTPStatus.NOT_FOUND, b"<HTML><BODY>404 Not Found</BODY></HTML>\n", "text/html")

    def _ptz(self, query: Mapping[str, str]) -> Reply:
        if "query" in query:
            return self._queried(query["query"])
        if "whoami" in query:
            return _text("Sony_camblock\r\n")
        if "info" in query:
            return _text("Available commands\r\n:\r\n{camera=[n]} pan=[-180 ... 180] tilt=[...] zoom=[1 ... 9999]\r\n")
        if not any(key in query for key in _MOVES):
            return Reply(HTTPStatus.NO_CONTENT)
        try:
            self.motors.command(query)
        except ValueError as problem:
            return _text(f"Error:\n{problem}\n")
        return Reply(HTTPStatus.NO_CONTENT)

    def _queried(self, what: str) -> Reply:
        if what == "position":
            return _text(wording.position_text(self.motors.told()))
        if what == "limits":
            return _text(wording.limits_text(self.motors.limits))
        if what == "speed":
            return _text("speed=100\r\n")
        if what == "attributes":
            return _text(wording.attributes_text(self._zoom_magnification, self.motors.deg_per_s))
        if what == "presetposall":
            return _text("Preset Positions for camera 1\r\npresetposno1=Home\r\n")
        return _text(wording.error_text("query", what))

    def _picture(self, query: Mapping[str, str]) -> Reply:
        width, times, height = query.get("resolution", f"{self.size[0]}x{self.size[1]}").partition("x")
        compression = query.get("compression", "30")
        if not (times and all(part.isdecimal() for part in (width, height, compression))):
            return _text(wording.error_text("resolution", query.get("resolution", "")))
        if not (0 < int(width) <= _MOST_SIDE and 0 < int(height) <= _MOST_SIDE and int(compression) <= 100):
            return _text(wording.error_text("resolution", query.get("resolution", "")))
        jpeg = self._snapshot((int(width), int(height)), int(compression))
        if self.faults.garbled_picture:
            jpeg = bytes(reversed(jpeg))
        cut_at = len(jpeg) // 2 if self.faults.truncated_picture else None
        return Reply(HTTPStatus.OK, jpeg, "image/jpeg", cut_at=cut_at)


def _text(text: str) -> Reply:
    return Reply(HTTPStatus.OK, text.encode())
