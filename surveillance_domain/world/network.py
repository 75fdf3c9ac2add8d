"""A network of pan/tilt/zoom cameras as a world: presets go out over HTTP, a sighting comes back.

The pace is fixed: cameras look ``step_s`` apart, for the belief moves on by ``step_s`` a step; between two looks they
turn. A camera that has not settled by then, or that failed, has an empty view in the sighting, which is not "nothing
seen". One that people have turned to where it has no preset is told apart, with where it looks.

Each camera has a thread of its own, and nobody waits for it longer than its deadline: one that hangs costs its own view
only, and is left out until it has come back. Looks are cut short so that what is left of the step is enough for the
longest move of any camera.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from surveillance_domain.cameras.base import Camera, Move, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraError, TooLate
from surveillance_domain.model.elsewhere import Elsewhere, Place
from surveillance_domain.model.reachability import longest_move_s
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.site.camera import Preset
from surveillance_domain.site.site import Site
from surveillance_domain.vision.ground import zoom_at
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.camera_report import PRIVATE, CameraReport
from surveillance_domain.world.eyes import Eyes, Look
from surveillance_domain.world.memory import Memory
from surveillance_domain.world.parking import Parked, sent_home
from surveillance_domain.world.yielding import MOVED, Yielding, taken, watching

__all__ = ["CameraReport", "NetworkWorld", "look_budget_s"]

T = TypeVar("T")

_LOOK_SHARE = 0.6
"""Of the time that the longest move leaves of a step; the rest is for the decision and the network."""
_LEAST_LOOK, _MOST_LOOK = 0.1, 0.5
"""Of a step, whatever the moves take."""
_GRACE_S = 0.02
"""For how long a camera is waited for after its own deadline."""
_POLL_S = 0.1
_MOST_POLLS = 600


def look_budget_s(site: Site) -> float:
    """How long a look may take, in seconds, so that no camera's move in the next step comes too late for it."""
    step_s = site.control.step_s
    left_s = step_s - max(longest_move_s(camera, step_s) for camera in site.cameras)
    return min(max(_LOOK_SHARE * left_s, _LEAST_LOOK * step_s), _MOST_LOOK * step_s)


@dataclass
class _Node:
    description: CameraDescription
    camera: Camera
    yielding: Yielding
    report: CameraReport = field(init=False)
    task: Future[Any] | None = None

    def __post_init__(self) -> None:
        self.report = CameraReport(self.description.name, self.camera.health)
        self.camera.watched_by(self.yielding)

    @property
    def free(self) -> bool:
        """Whether its thread has come back."""
        return self.task is None or self.task.done()

    def sent(self, preset: Preset, move: Move | None) -> None:
        """What came of a move; ``None``: it is not over."""
        self.report.moved(preset.name, move)
        self._told_of_others()

    def found(self, look: Look | None) -> None:
        """What came of a look; ``None``: nothing."""
        self.report.health = self.camera.health
        if look is not None:
            self.report.looked(look.position)
        self._told_of_others()

    def _told_of_others(self) -> None:
        if self.yielding.yields:
            self.report.moved_by_others()

    def view(self, look: Look | None) -> str | None:
        """The preset at which it looked, if it is one and it was still."""
        if look is None or not self.report.arrived:
            return None
        for preset in self.description.presets:
            if look.position.agrees(_position(preset), self.description.tolerance_deg):
                return preset.name
        return None

    def place(self, look: Look | None) -> Place | None:
        """Where it looked, if that is no preset of its own and it was still."""
        if look is None or not self.report.arrived or self.view(look) is not None:
            return None
        return look.position.pan, look.position.tilt, zoom_at(self.description, look.position)


class NetworkWorld:
    """Cameras that are spoken with.

    Parameters
    ----------
    site : Site
    cameras : sequence of Camera
        The drivers, in the site's order.
    eyes : Eyes
    clock : Clock
    held : callable, optional
        Names of the cameras that people hold now.
    moves : bool
        ``False``: never moves a camera (``--shadow``).
    memories : dict, optional
        Of cameras, by name: who was moved by somebody, from before and for later.

    Attributes
    ----------
    reports : dict
        For each camera, what became of it in the last step.
    late : int
        Steps that began after their look had been due, because whoever decides took so long; the pace begins anew then.
    """

    def __init__(
        self,
        site: Site,
        cameras: Sequence[Camera],
        eyes: Eyes,
        clock: Clock,
        held: Callable[[], Collection[str]] = frozenset,
        moves: bool = True,
        memories: Mapping[str, Memory] | None = None,
    ) -> None:
        self._clock, self._eyes, self._held, self._moves = clock, eyes, held, moves
        self._step_s, self._look_s, operation = site.control.step_s, look_budget_s(site), site.operation
        self._views_elsewhere = Elsewhere(site)
        self._nodes = {
            description.name: _Node(
                description, camera, watching(description, operation.yield_s, (memories or {}).get(description.name))
            )
            for description, camera in zip(site.cameras, cameras, strict=True)
        }
        self._pool = ThreadPoolExecutor(len(self._nodes), thread_name_prefix="camera")
        self._start = clock.now()
        self._due: float | None = None
        self.late = 0

    @property
    def reports(self) -> dict[str, CameraReport]:
        return {name: node.report for name, node in self._nodes.items()}

    def start(self, budget_s: float) -> dict[str, CameraError]:
        """Get to know all cameras; what is wrong with which. Those that fail may come back later."""
        tasks = {name: partial(_attempt, node.camera.start, budget_s) for name, node in self._nodes.items()}
        found = self._together(tasks, self._clock.now() + budget_s)
        faults: dict[str, CameraError] = {}
        for name, node in self._nodes.items():
            problem = found.get(name, TooLate(f"{name}: no answer in time"))
            if problem is not None:
                faults[name] = problem
                node.report.failed(problem)
        self._start = self._clock.now()
        return faults

    def move(self, presets: Mapping[str, str]) -> None:
        """Turn cameras to presets, until the next look is due."""
        now = self._clock.now()
        if self._due is None:
            self._start = self._due = now
        self._due += self._step_s
        if self._due <= now:
            self.late, self._due = self.late + 1, now + self._step_s
        kept = self._taken()
        going: dict[str, Preset] = {}
        for name, node in self._nodes.items():
            node.report = CameraReport(name, node.camera.health)
            if name in kept:
                node.report.because = kept[name]
                if not node.yielding.yields:
                    node.yielding.let_go()
            elif self._moves and name in presets:
                going[name] = _preset(node.description, presets[name])
        tasks: dict[str, Callable[[], Move | None]] = {
            name: partial(self._turn, self._nodes[name], preset, self._due) for name, preset in going.items()
        }
        for name, why in kept.items():
            if why == MOVED:
                tasks[name] = partial(self._follow, self._nodes[name], self._due)
        moves = self._together(tasks, self._due)
        for name, preset in going.items():
            self._nodes[name].sent(preset, moves.get(name))

    def observe(self) -> Sighting:
        """Wait until the look is due, and look through all cameras at once."""
        now = self._clock.now()
        self._due = now if self._due is None else self._due
        self._clock.sleep(self._due - now)
        looked = self._clock.now()
        until = looked + self._look_s
        tasks = {name: partial(self._look, node, until) for name, node in self._nodes.items()}
        looks: dict[str, Look] = {}
        for name, (look, seconds) in self._together(tasks, until).items():
            self._nodes[name].report.look_s = seconds
            if isinstance(look, Look):
                looks[name] = look
            else:
                self._nodes[name].report.failed(look)
        for name, node in self._nodes.items():
            node.found(looks.get(name))
        views = {name: node.view(looks.get(name)) for name, node in self._nodes.items()}
        elsewhere, private = self._elsewhere(looks)
        found = self._eyes.seen(looks, views, elsewhere)
        apart = {_called(one): camera for one, camera in found.beyond.items()}
        return Sighting(
            found.observations,
            views,
            looked - self._start,
            held=frozenset(self._taken()),
            unknown={_called(one): cell for one, cell in found.unknown.items()},
            without_identity=found.without_identity,
            out_of_view=found.out_of_view,
            beyond={one: camera for one, camera in apart.items() if camera not in elsewhere},
            elsewhere=elsewhere,
            through={one: camera for one, camera in apart.items() if camera in elsewhere},
            private=private,
        )

    def park(self) -> dict[str, Parked]:
        """Send every camera that nobody has to its ``home`` preset; for each camera what became of it."""
        kept = self._taken()
        going = {name: node for name, node in self._nodes.items() if name not in kept}
        longest_s = max((node.description.move_deadline_s for node in going.values()), default=0.0)
        tasks = {name: partial(sent_home, node.camera, node.description) for name, node in going.items()}
        done = self._together(tasks, self._clock.now() + longest_s)
        alone = {name: Parked(True, f"left alone: {why}") for name, why in kept.items()}
        return {name: {**done, **alone}.get(name, Parked(False, "no answer in time")) for name in self._nodes}

    def close(self) -> None:
        """Let go of the cameras, once their threads have come back."""
        for _ in range(_MOST_POLLS):
            if all(node.free for node in self._nodes.values()):
                break
            self._clock.sleep(_POLL_S)
        self._pool.shutdown(wait=False, cancel_futures=True)
        for node in self._nodes.values():
            node.camera.close()

    def _elsewhere(self, looks: Mapping[str, Look]) -> tuple[dict[str, Place], frozenset[str]]:
        """Where cameras look that see floor from no preset of theirs, and which look into a private area."""
        elsewhere, private = {}, set[str]()
        for name, node in self._nodes.items():
            place = node.place(looks.get(name))
            if place is None:
                continue
            detection = self._views_elsewhere.detection(name, place)
            if detection is None:
                private.add(name)
                node.report.because = node.report.because or PRIVATE
            elif detection.any():
                elsewhere[name] = place
        return elsewhere, frozenset(private)

    def _taken(self) -> dict[str, str]:
        return taken({name: node.yielding for name, node in self._nodes.items()}, self._held())

    def _together(self, tasks: Mapping[str, Callable[[], T]], until: float) -> dict[str, T]:
        """What came of tasks, one a camera, where it came in time."""
        free = {name: task for name, task in tasks.items() if self._nodes[name].free}
        futures = self._clock.together(self._pool, list(free.values()), until + _GRACE_S)
        done = {}
        for name, future in zip(free, futures, strict=True):
            self._nodes[name].task = future
            if future.done():
                done[name] = future.result()
        for name in tasks.keys() - done.keys():
            self._nodes[name].report.failed(TooLate(f"{name}: no answer in time"))
        return done

    def _turn(self, node: _Node, preset: Preset, until: float) -> Move:
        return node.camera.move(_position(preset), until - self._clock.now())

    def _follow(self, node: _Node, until: float) -> None:
        """Where somebody moves it, told to who watches it; a look may be too short for its answer."""
        with suppress(CameraError):
            node.camera.position(until - self._clock.now())

    def _look(self, node: _Node, until: float) -> tuple[Look | CameraError, float]:
        """A look, or why there is none, and how long it took in seconds."""
        started = self._clock.now()
        try:
            result: Look | CameraError = self._eyes.look(node.camera, until - started)
        except CameraError as problem:
            result = problem
        return result, self._clock.now() - started


def _called(identity: int | str) -> str:
    """What a sighting calls somebody."""
    return f"marker {identity}" if isinstance(identity, int) else identity


def _attempt(start: Callable[[float], object], budget_s: float) -> CameraError | None:
    try:
        start(budget_s)
    except CameraError as problem:
        return problem
    return None


def _preset(description: CameraDescription, name: str) -> Preset:
    for preset in description.presets:
        if preset.name == name:
            return preset
    raise ValueError(f"no preset {name!r} of camera {description.name!r}")


def _position(preset: Preset) -> Position:
    return Position(preset.pan, preset.tilt, preset.zoom)
