"""What is wrong with a camera, and what would mend it: one check after the other, as far as they make sense."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime

from surveillance_domain.cameras.base import Move, Outcome, Picture, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import (
    BadAnswer,
    CameraError,
    LoginRefused,
    OutsideLimits,
    Unreachable,
    Untrusted,
    without_name,
)
from surveillance_domain.cameras.mending import mend_of
from surveillance_domain.cameras.tls import other_scheme
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.cameras.witness import MOVED
from surveillance_domain.model.views import Views
from surveillance_domain.site.camera import Preset
from surveillance_domain.site.site import Site
from surveillance_domain.vision.calibration_file import Calibrated
from surveillance_domain.vision.ground import preset_at
from surveillance_domain.vision.points import FloorMarker
from surveillance_domain.world.doctor_pictures import calibration, markers_known, markers_readable, resolution
from surveillance_domain.world.doctor_points import points_found
from surveillance_domain.world.memory import Memory, still_for_s

__all__ = ["Check", "Examination"]

_BUDGET_S = 5.0
_MOST_AHEAD_S = 10.0
_WATCHED_S = 1.0
_QUEUE = "CtlQueueing"
_OVERVIEW = "ReturnToOverview"
_ON = frozenset({"yes", "true", "on", "1"})


@dataclass(frozen=True)
class Check:
    """One thing that was looked at.

    Attributes
    ----------
    name : str
    ok : bool
    detail : str
        What was found, and what would mend it.
    """

    name: str
    ok: bool
    detail: str


@dataclass(frozen=True, eq=False)
class Examination:
    """How cameras of a site are examined.

    Attributes
    ----------
    site : Site
    views : Views
        Of the site.
    clock : Clock
    moves : bool
        Whether a camera may be turned, and back again.
    markers : dict
        Markers that lie at known places, if any do.
    today : callable
        The time of day (UTC).
    calibrated : dict
        What cameras' presets were calibrated from, by camera and preset, to be looked for again.
    memories : dict
        Of cameras, by name: who was moved by somebody, and is not turned until it has been still for ``yield_s``.
    """

    site: Site
    views: Views
    clock: Clock
    moves: bool = True
    markers: Mapping[int, FloorMarker] | None = None
    today: Callable[[], datetime] = lambda: datetime.now(UTC)
    calibrated: Mapping[str, Mapping[str, Calibrated]] = field(default_factory=dict)
    memories: Mapping[str, Memory] = field(default_factory=dict)

    def of(self, camera: VapixCamera, held: bool = False) -> tuple[Check, ...]:
        """All checks of one camera, which is not turned if people hold it."""
        return tuple(self._checks(camera, held))

    def _checks(self, camera: VapixCamera, held: bool) -> Iterator[Check]:
        started = self.clock.now()
        try:
            here = camera.position(_BUDGET_S)
        except LoginRefused as problem:
            yield Check("reachability", True, "answers")
            yield _failed("authentication", problem, camera)
            return
        except CameraError as problem:
            yield self._unreached(camera, problem)
            return
        user = camera.description.username
        all_of_it = ", the log-in being part of it" if user else ""
        yield Check("reachability", True, f"answers in {1000 * (self.clock.now() - started):.0f} ms{all_of_it}")
        yield Check("authentication", True, f"lets {user} in" if user else "lets everybody in")
        yield _limits(camera)
        picture = None
        try:
            with suppress(OutsideLimits):
                camera.start(_BUDGET_S)
            picture = camera.picture(_BUDGET_S)
            yield Check("snapshot", True, f"a JPEG of {len(picture.jpeg):,} bytes")
        except CameraError as problem:
            yield _failed("snapshot", problem, camera)
        yield from self._of_pictures(camera, picture)
        yield from _others(camera)
        yield from self._clock_check(camera)
        turns = self.moves and not held
        still_s = self._still_for_s(camera, here) if turns else None
        if still_s is not None:
            turns = False
            yield Check("move", True, f"not turned: {MOVED} {still_s:.0f} s ago")
        if turns:
            moved = self._move(camera, here)
            turns = moved.ok
            yield moved
        yield from self._points(camera, here, turns)

    def _unreached(self, camera: VapixCamera, problem: CameraError) -> Check:
        url = camera.description.url or ""
        if isinstance(problem, Untrusted | BadAnswer | Unreachable):
            other = other_scheme(url, camera.description.connect_timeout_s)
            if other is not None:
                told = without_name(problem, camera.name)
                right = f"{other}://{url.partition('://')[2]}"
                return Check("reachability", False, f"{told}; it speaks {other} at this port: set url = {right!r}")
        return _failed("reachability", problem, camera)

    def _of_pictures(self, camera: VapixCamera, picture: Picture | None) -> Iterator[Check]:
        description = camera.description
        number = [one.name for one in self.site.cameras].index(camera.name)
        if picture is not None:
            yield Check("resolution", *resolution(description, picture))
        if self.site.markers is not None:
            yield Check("markers", *markers_readable(self.site, description, self.views.detection[number]))
        if any(preset.homography is not None for preset in description.presets):
            yield Check("calibration", *calibration(self.site, description, self.views.detection[number]))
        if self.markers and picture is not None and self.site.markers is not None:
            yield Check("known markers", *markers_known(self.site, description, picture, self.markers))

    def _points(self, camera: VapixCamera, here: Position, turns: bool) -> Iterator[Check]:
        """Whether what its presets were calibrated from is still seen where it was."""
        known = self.calibrated.get(camera.name, {})
        if not known:
            return
        description, pictures = camera.description, dict[str, Picture]()
        standing = preset_at(description, here)
        try:
            for preset in description.presets:
                if preset.name in known and (turns or preset == standing):
                    there = camera.move(_at(preset), description.move_deadline_s) if turns else None
                    if there is None or there.outcome is Outcome.REACHED:
                        pictures[preset.name] = camera.picture(_BUDGET_S)
        except CameraError as problem:
            yield _failed("calibration points", problem, camera)
            return
        finally:
            if turns:
                camera.move(here, description.move_deadline_s)
        yield Check("calibration points", *points_found(self.site, description, known, pictures))

    def _clock_check(self, camera: VapixCamera) -> Iterator[Check]:
        try:
            shown = camera.time_of_day(_BUDGET_S)
        except CameraError as problem:
            yield _failed("clock", problem, camera)
            return
        if shown is None:
            return
        ahead_s = (shown - self.today()).total_seconds()
        off = f"{abs(ahead_s):.0f} s {'ahead of' if ahead_s > 0 else 'behind'}"
        if abs(ahead_s) <= _MOST_AHEAD_S:
            yield Check("clock", True, f"{off} this machine's")
        else:
            yield Check("clock", False, f"{off} this machine's: give both the same time server (NTP)")

    def _still_for_s(self, camera: VapixCamera, here: Position) -> float | None:
        """For how long it has been still, if somebody moved it a moment ago."""
        memory = self.memories.get(camera.name, Memory())
        return still_for_s(memory, self.site.operation.yield_s, camera.description.tolerance_deg, here)

    def _move(self, camera: VapixCamera, here: Position) -> Check:
        """To a preset that it is not at, and back."""
        description = camera.description
        self.clock.sleep(_WATCHED_S)
        try:
            if not camera.position(_BUDGET_S).agrees(here, description.tolerance_deg):
                return Check(
                    "move", False, "it is moving already: is somebody at its joystick, or a guard tour running?"
                )
        except CameraError as problem:
            return _failed("move", problem, camera)
        within = [one for one in description.presets if camera.limits is None or not camera.limits.faults(_at(one))]
        elsewhere = [one for one in within if not _at(one).agrees(here, description.tolerance_deg)]
        if not within:
            return Check("move", False, "not turned: it can reach none of its presets")
        if not elsewhere:
            return Check("move", True, "the only preset that it can reach is where it looks")
        there = elsewhere[0]
        out = camera.move(_at(there), description.move_deadline_s)
        if out.outcome is not Outcome.REACHED:
            self._call_back(camera, here)
        back = camera.move(here, description.move_deadline_s)
        for move, where in ((out, f'to "{there.name}"'), (back, "back again")):
            if move.outcome is not Outcome.REACHED:
                mend = mend_of(move.fault) or "is it held, blocked, or told to move by somebody else?"
                return Check("move", False, f"{where}: {move.outcome}: {move.because}; {_left(back)}; {mend}")
        return Check("move", True, f'to "{there.name}" in {out.seconds:.2f} s, settled, and back')

    def _call_back(self, camera: VapixCamera, here: Position) -> None:
        """Send it back even where it tells that it is there: a camera whose move failed may tell anything."""
        try:
            camera.send(here, self.clock.now() + _BUDGET_S)
        except CameraError:
            return  # the move that follows tells why


def _left(back: Move) -> str:
    """Where the test leaves a camera, by what that tells."""
    if back.position is None:
        return "where it looks now it does not tell"
    where = f"pan {back.position.pan:g}, tilt {back.position.tilt:g}"
    return f"sent back, it tells {where}" if back.outcome is Outcome.REACHED else f"left at {where}, as it tells"


def _at(preset: Preset) -> Position:
    return Position(preset.pan, preset.tilt, preset.zoom)


def _limits(camera: VapixCamera) -> Check:
    try:
        limits = camera.read_limits(_BUDGET_S)
    except CameraError as problem:
        return _failed("limits", problem, camera)
    ends = {"pan": limits.pan, "tilt": limits.tilt, "zoom": limits.zoom}
    told = ", ".join(f"{axis} {low:g} to {high:g}" for axis, end in ends.items() if end for low, high in (end,))
    return Check("limits", True, f"all presets lie within {told}")


def _others(camera: VapixCamera) -> Iterator[Check]:
    """Whether the camera is set to turn by itself, or to serve others first; not all models tell."""
    told: dict[str, str] = {}
    for group in ("PTZ", "GuardTour"):
        try:
            told |= camera.parameters(group, _BUDGET_S)
        except CameraError:
            continue
    if not told:
        return
    found = []
    for name, value in sorted(told.items()):
        last = name.rpartition(".")[2]
        if last == "Running" and "GuardTour" in name and value.lower() in _ON:
            found.append(f"a guard tour runs ({name}): stop it")
        elif "autopilot" in name.lower() and value.lower() in _ON:
            found.append(f"its autopilot is on ({name}): switch it off")
        elif last == _QUEUE and value.lower() in _ON:
            found.append(f"a control queue is on ({name}): switch it off, or commands wait for their turn")
        elif last == _OVERVIEW and value not in ("0", ""):
            found.append(f"it returns to its overview after {value} s ({name}): set that to 0")
    yield Check(
        "other masters", not found, "; ".join(found) or "no guard tour, autopilot or control queue that it tells of"
    )


def _failed(name: str, problem: CameraError, camera: VapixCamera) -> Check:
    mend, told = mend_of(type(problem).__name__), without_name(problem, camera.name)
    described = camera.description
    if isinstance(problem, LoginRefused) and described.username and described.password_env:
        mend = mend.replace("the password of username", f"the password of {described.username}")
        mend = mend.replace("the environment variable that password_env names", described.password_env)
    return Check(name, False, f"{told}; {mend}" if mend else told)
