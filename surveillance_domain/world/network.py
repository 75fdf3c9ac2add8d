"""A network of pan/tilt/zoom cameras as a world: presets go out over HTTP, a sighting comes back.

The pace is fixed: cameras look at ``t₀ + k · step_s``, for the belief moves on by ``step_s`` a step; between two looks
they turn. A camera that has not settled by then, that failed, or that looks somewhere that is no preset of its own has
an empty view in the sighting, which is not "nothing seen". Each camera has a thread of its own: one that hangs costs
its own view only.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial

from surveillance_domain.cameras.base import Camera, Health, Move, Outcome, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraError
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.site.camera import Preset
from surveillance_domain.site.site import Site
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.eyes import Eyes, Look
from surveillance_domain.world.yielding import Yielding, taken

__all__ = ["CameraReport", "NetworkWorld"]

_LOOK_SHARE = 0.5
"""Of a step, at the most, for a look."""


@dataclass
class CameraReport:
    """What became of one camera in the last step.

    Attributes
    ----------
    sent : str or None
        The preset it was sent to; ``None``: it got no command.
    outcome : str
        Of its move; empty if it got none.
    position : Position or None
        Read back with its look.
    move_s, look_s : float
        How long they took.
    because : str
        What went wrong with it, or why it got no command; empty if nothing did.
    health : Health
    """

    health: Health
    sent: str | None = None
    outcome: str = ""
    position: Position | None = None
    move_s: float = 0.0
    look_s: float = 0.0
    because: str = ""


@dataclass
class _Node:
    description: CameraDescription
    camera: Camera
    yielding: Yielding
    report: CameraReport = field(init=False)

    def __post_init__(self) -> None:
        self.report = CameraReport(self.camera.health)


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

    Attributes
    ----------
    reports : dict
        For each camera, what became of it in the last step.
    """

    def __init__(
        self,
        site: Site,
        cameras: Sequence[Camera],
        eyes: Eyes,
        clock: Clock,
        held: Callable[[], Collection[str]] = frozenset,
        moves: bool = True,
    ) -> None:
        self._clock, self._eyes, self._held, self._moves = clock, eyes, held, moves
        self._step_s, operation = site.control.step_s, site.operation
        self._nodes = {
            description.name: _Node(description, camera, Yielding(description.tolerance_deg, operation.yield_s))
            for description, camera in zip(site.cameras, cameras, strict=True)
        }
        self._pool = ThreadPoolExecutor(len(self._nodes), thread_name_prefix="camera")
        self._start, self._due = clock.now(), clock.now()

    @property
    def reports(self) -> dict[str, CameraReport]:
        return {name: node.report for name, node in self._nodes.items()}

    def start(self, budget_s: float) -> dict[str, str]:
        """Get to know all cameras; what is wrong with which. Those that fail may come back later."""
        tasks = [partial(node.camera.start, budget_s) for node in self._nodes.values()]
        faults = {}
        for name, done in zip(self._nodes, self._clock.together(self._pool, tasks), strict=True):
            if isinstance(problem := done.exception(), CameraError):
                faults[name] = str(problem)
            elif problem is not None:
                raise problem
        self._start = self._due = self._clock.now()
        return faults

    def move(self, presets: Mapping[str, str]) -> None:
        """Turn cameras to presets, until the next look is due."""
        self._due = max(self._due + self._step_s, self._clock.now())
        kept = taken({name: node.yielding for name, node in self._nodes.items()}, self._held())
        going = []
        for name, node in self._nodes.items():
            node.report = CameraReport(node.camera.health)
            if name in kept:
                node.report.because = kept[name]
                node.yielding.left_at(None)
            elif self._moves and name in presets:
                going.append((node, _preset(node.description, presets[name])))
        tasks = [partial(self._turn, node, preset) for node, preset in going]
        for done in self._clock.together(self._pool, tasks):
            done.result()

    def observe(self) -> Sighting:
        """Wait until the look is due, and look through all cameras at once."""
        self._clock.sleep(self._due - self._clock.now())
        tasks = [partial(self._look, node) for node in self._nodes.values()]
        found = [done.result() for done in self._clock.together(self._pool, tasks)]
        looks = {name: look for name, look in zip(self._nodes, found, strict=True) if look is not None}
        views = {name: _view(node, looks.get(name)) for name, node in self._nodes.items()}
        kept = taken({name: node.yielding for name, node in self._nodes.items()}, self._held())
        at = self._clock.now() - self._start
        return Sighting(self._eyes.seen(looks, views), views, at, held=frozenset(kept))

    def park(self, budget_s: float) -> dict[str, str]:
        """Send every camera that nobody holds to its ``home`` preset; for each camera what became of it."""
        kept = taken({name: node.yielding for name, node in self._nodes.items()}, self._held())
        going = {name: node for name, node in self._nodes.items() if name not in kept and node.description.home}
        tasks = [
            partial(node.camera.move, _position(_preset(node.description, str(node.description.home))), budget_s)
            for node in going.values()
        ]
        outcomes = {name: f"left alone: {why}" for name, why in kept.items()}
        for name in self._nodes.keys() - going.keys() - kept.keys():
            outcomes[name] = "has no home preset"
        for name, done in zip(going, self._clock.together(self._pool, tasks), strict=True):
            move: Move = done.result()
            outcomes[name] = str(move.outcome) + (f": {move.because}" if move.because else "")
        return {name: outcomes[name] for name in self._nodes}

    def close(self) -> None:
        """Let go of the cameras."""
        self._pool.shutdown()
        for node in self._nodes.values():
            node.camera.close()

    def _turn(self, node: _Node, preset: Preset) -> None:
        move = node.camera.move(_position(preset), self._due - self._clock.now())
        reached = move.outcome is Outcome.REACHED
        node.yielding.left_at(_position(preset) if reached else None)
        node.report.sent, node.report.outcome = preset.name, str(move.outcome)
        node.report.move_s, node.report.because = move.seconds, move.because

    def _look(self, node: _Node) -> Look | None:
        started = self._clock.now()
        try:
            look = self._eyes.look(node.camera, _LOOK_SHARE * self._step_s)
        except CameraError as problem:
            node.report.because = node.report.because or str(problem)
            node.yielding.left_at(None)
            return None
        finally:
            node.report.look_s, node.report.health = self._clock.now() - started, node.camera.health
        node.report.position = look.position
        node.yielding.found_at(look.position, self._clock.now())
        return look


def _preset(description: CameraDescription, name: str) -> Preset:
    for preset in description.presets:
        if preset.name == name:
            return preset
    raise ValueError(f"no preset {name!r} of camera {description.name!r}")


def _position(preset: Preset) -> Position:
    return Position(preset.pan, preset.tilt, preset.zoom)


def _view(node: _Node, look: Look | None) -> str | None:
    """The preset at which a camera looked, if it is one and it was still."""
    if look is None or node.report.outcome == Outcome.TIMED_OUT:
        return None
    for preset in node.description.presets:
        if look.position.agrees(_position(preset), node.description.tolerance_deg):
            return preset.name
    return None
