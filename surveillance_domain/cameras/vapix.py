"""The driver for AXIS cameras: VAPIX over HTTP."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from datetime import datetime
from email.utils import parsedate_to_datetime
from typing import TypeVar

import numpy as np

from surveillance_domain.cameras import answers
from surveillance_domain.cameras.base import Health, HealthState, Limits, Move, Outcome, Picture, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import (
    BadPicture,
    CameraAway,
    CameraError,
    OutsideLimits,
    Refused,
    TooSlow,
    Unreachable,
    without_name,
)
from surveillance_domain.cameras.exchange import Answer, Exchange
from surveillance_domain.cameras.moving import Pace, drive
from surveillance_domain.cameras.pictures import jpeg_size
from surveillance_domain.cameras.rests import Breaker
from surveillance_domain.cameras.retry import with_retries
from surveillance_domain.cameras.steadiness import Steadiness
from surveillance_domain.cameras.witness import Witness
from surveillance_domain.site.camera import Camera as CameraDescription

__all__ = ["VapixCamera"]

T = TypeVar("T")

_PTZ = "/axis-cgi/com/ptz.cgi"
_MOST_PICTURE_BYTES = 16_000_000
_SLOW_S = 0.1
"""An answer that takes no longer is not called slow."""
_ROUNDING_S = 1e-3


class VapixCamera:
    """An AXIS camera.

    Parameters
    ----------
    description : CameraDescription
        What the site says of it.
    exchange : Exchange
        Its HTTP side; see `surveillance_domain.cameras.opening.open_camera`.
    clock : Clock
    rng : numpy.random.Generator
        For the jitter of retries.
    compression : int
        Of pictures, 0 to 100.
    """

    def __init__(
        self,
        description: CameraDescription,
        exchange: Exchange,
        clock: Clock,
        rng: np.random.Generator,
        compression: int = 20,
    ) -> None:
        self.description = description
        self.steadiness = Steadiness(description.tolerance_deg / 2)
        self.witness = Witness()
        self.limits: Limits | None = None
        self.picture_size: tuple[int, int] | None = None
        self._exchange, self._clock, self._rng, self._compression = exchange, clock, rng, compression
        self._resolution: str | None = f"{description.image.width}x{description.image.height}"
        self._breaker = Breaker(clock)
        self._pace = Pace(description.tolerance_deg, description.settle_s, self._travel_s)
        self._lock = threading.RLock()
        self._failures, self._because = 0, ""
        self._answer_s, self._budget_s = 0.0, 0.0

    def __repr__(self) -> str:
        return f"VapixCamera({self.name!r})"

    @property
    def name(self) -> str:
        return self.description.name

    @property
    def health(self) -> Health:
        if self._exchange.lockout.until is not None:
            return Health(HealthState.LOCKED_OUT, self._failures, self._exchange.lockout.until, self._because)
        away = self._breaker.until is not None or self._breaker.half_open
        return Health(
            HealthState.AWAY if away else HealthState.READY, self._failures, self._breaker.until, self._because
        )

    def watched_by(self, witness: Witness) -> None:
        self.witness = witness

    def read_limits(self, budget_s: float) -> Limits:
        """Read the limits, and refuse presets outside.

        Raises
        ------
        OutsideLimits
            Naming every preset that lies outside, and how.
        CameraError
            If the camera cannot be asked.
        """
        with self._lock:
            self._budget_s = budget_s
            limits = self._read_limits(self._clock.now() + budget_s)
            faults = [f'"{p.name}": {fault}' for p in self.description.presets for fault in limits.faults(_of(p))]
            if faults:
                raise OutsideLimits(f"{self.name}: presets that the camera would clamp: {'; '.join(faults)}")
            return limits

    def start(self, budget_s: float) -> Limits:
        """Read the limits (see `read_limits`, and what it raises), and find out in which size pictures come."""
        with self._lock:
            until = self._clock.now() + budget_s
            limits = self.read_limits(budget_s)
            self._probe_resolution(until)
            return limits

    def position(self, budget_s: float) -> Position:
        with self._lock:
            self._budget_s = budget_s
            return self.read(self._clock.now() + budget_s)

    def move(self, target: Position, budget_s: float) -> Move:
        with self._lock:
            start, self._budget_s = self._clock.now(), budget_s
            try:
                limits = self.limits or self._read_limits(start + budget_s)
            except CameraError as error:
                spent_s = self._clock.now() - start
                because = without_name(error, self.name)
                return Move(Outcome.UNREACHABLE, None, spent_s, because, type(error).__name__)
            faults = limits.faults(target)
            if faults:
                return Move(Outcome.STALLED, None, 0.0, f"not sent, the camera would clamp: {faults[0]}")
            move = drive(self, target, self._pace, self._clock, self._rng, start + budget_s)
            return replace(move, because=without_name(move.because, self.name))

    def picture(self, budget_s: float) -> Picture:
        """A picture, if the positions before and after it agree.

        Raises
        ------
        BadPicture
            If they do not, or it is no whole JPEG.
        CameraError
            If the camera cannot be asked.
        """
        with self._lock:
            until, self._budget_s = self._clock.now() + budget_s, budget_s
            before = self.read(until)
            jpeg, (width, height) = self._fetch_picture(self._resolution, until)
            after = self.read(until)
            if not after.agrees(before, self.description.tolerance_deg):
                raise BadPicture(f"{self.name}: it moved while the picture was taken")
            return Picture(jpeg, width, height, after, self._clock.now())

    def attributes(self, budget_s: float) -> dict[str, str]:
        """The answer to ``query=attributes``, as the camera words it; older models have none and refuse."""
        with self._lock:
            return self._query("attributes", self._clock.now() + budget_s, answers.key_values)

    def parameters(self, group: str, budget_s: float) -> dict[str, str]:
        """The parameters of a group such as ``PTZ``, by full names such as ``root.PTZ.Various.V1.CtlQueueing``."""
        with self._lock:
            query = {"action": "list", "group": group}
            answer = self._ask("/axis-cgi/param.cgi", query, self._clock.now() + budget_s)
            return self._parsed(answer, answers.key_values)

    def image_size(self, budget_s: float) -> tuple[int, int]:
        """Width and height that the camera itself is set to, in pixels."""
        with self._lock:
            query = {"camera": str(self.description.channel)}
            answer = self._ask("/axis-cgi/imagesize.cgi", query, self._clock.now() + budget_s)
            return self._parsed(answer, answers.image_size)

    def time_of_day(self, budget_s: float) -> datetime | None:
        """What its own clock shows, to the second; ``None`` where it does not tell."""
        with self._lock:
            query = {"query": "position", "camera": str(self.description.channel)}
            date = self._ask(_PTZ, query, self._clock.now() + budget_s).date
            try:
                return parsedate_to_datetime(date)
            except ValueError:
                return None

    def close(self) -> None:
        self._exchange.close()

    # ---------------------------------------------------------------------------------------------- Motors, for `drive`

    def read(self, until: float) -> Position:
        """The position now; see `position`."""
        asked = self._clock.now()
        found = self._query("position", until, answers.position)
        now = self._clock.now()
        self.steadiness.read(found, now)
        self.witness.read(found, asked, now)
        return found

    def send(self, target: Position, until: float) -> None:
        """Ask for an absolute move, once."""
        query = {"camera": str(self.description.channel), "pan": f"{target.pan:.4f}", "tilt": f"{target.tilt:.4f}"}
        if target.zoom is not None:
            query["zoom"] = f"{target.zoom:.0f}"
        query["speed"] = "100"
        self.witness.sent(target, self._clock.now())
        answer = self._counted(lambda: self._exchanged(_PTZ, query, until), until)
        reason = answers.refusal(answer.text)
        if reason is not None:
            raise Refused(f"{self.name}: the camera refuses to move: {reason}")
        self.witness.accepted(target)

    # ------------------------------------------------------------------------------------------------------ asking

    def _read_limits(self, until: float) -> Limits:
        self.limits = self._query("limits", until, answers.limits)
        return self.limits

    def _probe_resolution(self, until: float) -> None:
        """Ask for pictures in the site's size, or as the camera likes if it does not know that one."""
        try:
            _, self.picture_size = self._fetch_picture(self._resolution, until)
        except Refused:
            _, self.picture_size = self._fetch_picture(None, until)
            self._resolution = None

    def _fetch_picture(self, resolution: str | None, until: float) -> tuple[bytes, tuple[int, int]]:
        query = {"camera": str(self.description.channel), "compression": str(self._compression)}
        if resolution is not None:
            query["resolution"] = resolution
        answer = self._ask("/axis-cgi/jpg/image.cgi", query, until, _MOST_PICTURE_BYTES)
        try:
            return answer.body, jpeg_size(answer.body)
        except CameraError as error:
            raise type(error)(f"{self.name}: {error}") from None

    def _query(self, what: str, until: float, parse: Callable[[str], T]) -> T:
        answer = self._ask(_PTZ, {"query": what, "camera": str(self.description.channel)}, until)
        return self._parsed(answer, parse)

    def _parsed(self, answer: Answer, parse: Callable[[str], T]) -> T:
        try:
            return parse(answer.text)
        except CameraError as error:
            raise type(error)(f"{self.name}: {error}") from None

    def _ask(self, path: str, query: dict[str, str], until: float, most_bytes: int = 1_000_000) -> Answer:
        def attempt() -> Answer:
            return self._exchanged(path, query, until, most_bytes)

        return self._counted(lambda: with_retries(attempt, self._clock, self._rng, until), until)

    def _exchanged(self, path: str, query: dict[str, str], until: float, most_bytes: int = 1_000_000) -> Answer:
        """Ask once; a camera that answers, but takes longer than there is time, is told from one that is silent."""
        asked = self._clock.now()
        try:
            answer = self._exchange.get(path, query, until, most_bytes)
        except Unreachable:
            usual_s, left_s, now = self._answer_s, max(until - asked, 0.0), self._clock.now()
            if now - asked >= usual_s:
                self._answer_s = 0.0
            if usual_s <= max(left_s, _SLOW_S) or now < until - _ROUNDING_S:
                raise
        else:
            self._answer_s = self._clock.now() - asked
            return answer
        raise TooSlow(f"{self.name}: {TooSlow.because(usual_s, self._budget_s)}")

    def _counted(self, ask: Callable[[], Answer], until: float) -> Answer:
        """Ask, if the camera may be asked: while it rests it may not, and then one question decides."""
        for rest in (self._exchange.lockout, self._breaker):
            if rest.until is not None:
                left = rest.until - self._clock.now()
                raise CameraAway(f"{self.name}: left alone for another {max(1, round(left))} s; {self._because}")
        try:
            if self._breaker.half_open:
                self._exchanged(_PTZ, {"query": "position", "camera": str(self.description.channel)}, until)
                self._breaker.succeeded()
            answer = ask()
        except CameraError as error:
            self._fail(error)
            raise
        self._breaker.succeeded()
        return answer

    def _fail(self, error: CameraError) -> None:
        """Count a failure; a camera that did not answer may have rebooted, so what was known of it is not any more."""
        self._failures, self._because = self._failures + 1, without_name(error, self.name)
        self.witness.failed()
        if isinstance(error, Unreachable):
            self._breaker.failed()
            self.limits = None
            self.steadiness.forget()

    def _travel_s(self, here: Position, there: Position) -> float:
        """Least time between two positions by the speeds that the site gives; zero if it gives none."""
        away = [(here.pan, there.pan, self.description.pan_deg_per_s)]
        away.append((here.tilt, there.tilt, self.description.tilt_deg_per_s))
        if here.zoom is not None and there.zoom is not None:
            away.append((here.zoom, there.zoom, self.description.zoom_per_s))
        return max((abs(end - start) / speed for start, end, speed in away if speed is not None), default=0.0)


def _of(preset: object) -> Position:
    """A preset's position."""
    return Position(*(float(getattr(preset, axis)) for axis in ("pan", "tilt", "zoom")))
