"""People at the cameras, and cameras that fail without people: who is yielded to, and who is left alone for nothing.

``python -m tests.people_campaign people 30 0 0.0`` prints a line of JSON with what became of 30 moves that people made
at random moments, answers taking 0.0 s; ``python -m tests.people_campaign alone 200 0 drop "503+late moves"`` a line
for each fault, or faults joined by ``+``, of one camera, with the number of steps in which any was left alone.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import cycle
from typing import Any

import numpy as np

from surveillance_domain.cameras.base import Camera, Position
from surveillance_domain.emulation.kinematics import Axes, Journey
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.world.eyes import Eyes, Look
from tests.emulated_cameras import jpeg
from tests.emulated_watch import FAULTS, Emulated, campaign, emulated_watch, lego

__all__ = ["main"]

STEP_S = 1.5
_KINDS = ("jump", "preset", "drag")
_DRAG_S, _DRAG_EVERY_S = 2.4, 0.15


class Hands:
    """Somebody at a camera's joystick, and what the camera would have told without them.

    Commands given here come through at their own time, as exactly as those of the driver.
    """

    def __init__(self, motors: EmulatedMotors, tolerance_deg: float) -> None:
        self._motors, self._tolerance_deg = motors, tolerance_deg
        self._due: list[tuple[float, Axes]] = []
        self._late_s: Callable[[], float] | None = None
        self._late: list[tuple[float, dict[str, str]]] = []
        self._without: Journey | None = None
        self.touched_s: float | None = None
        self.readable_s: float | None = None
        self.commands: list[float] = []
        self._now, self._told, self._command = motors._now, motors.told, motors.command
        motors._now, motors.told, motors.command = self.now, self.told, self.command  # type: ignore[method-assign]

    def turn(self, at_s: float, goal: Axes) -> None:
        """Go there, at that time."""
        self._due.append((at_s, goal))

    def forget(self) -> None:
        """What they did before is over."""
        self.touched_s, self.readable_s, self._without = None, None, None
        self.commands.clear()

    def late(self, by_s: Callable[[], float] | None) -> None:
        """From now on the camera sets off so much later than it says, on one command after the other."""
        self._late_s = by_s

    def now(self) -> float:
        now = self._motors._clock.now()
        while self._due and self._due[0][0] <= now:
            at_s, goal = self._due.pop(0)
            if self.touched_s is None:
                self.touched_s, self._without = at_s, self._motors._journey
            self._motors._journey = self._motors._journey.onward(goal, at_s)
        while self._late and self._late[0][0] <= now:
            self._command(self._late.pop(0)[1])
        return self._now()

    def told(self) -> Axes:
        found = self._told()
        if self._without is not None and self.readable_s is None:
            now = self._motors._clock.now()
            if not Position(*found).agrees(Position(*self._without.at(now)), self._tolerance_deg):
                self.readable_s = now
        return found

    def command(self, query: Mapping[str, str]) -> None:
        """The driver's."""
        now = self.now()
        self.commands.append(now)
        if self._late_s is not None:
            before = self._late[-1][0] if self._late else now
            self._late.append((max(before, now + self._late_s()), dict(query)))
            return
        self._command(query)
        if self._without is not None:
            self._without = self._without.onward(self._motors._journey.goal, now)


class Photographing:
    """Drawn detections; the position is that of a whole picture."""

    def __init__(self, drawn: Eyes) -> None:
        self._drawn = drawn

    def look(self, camera: Camera, budget_s: float) -> Look:
        picture = camera.picture(budget_s)
        return Look(picture.position, picture.position)

    def seen(self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]) -> Any:
        return self._drawn.seen(looks, views, elsewhere)


def _eyes(emulation: EmulatedSite, drawn: Eyes) -> Eyes:
    small = jpeg()
    for camera in emulation.cameras.values():
        camera._snapshot = lambda size, compression: small
    return Photographing(drawn)


@dataclass
class Found:
    """What became of people's moves."""

    moves: int = 0
    readable: int = 0
    yielded: int = 0
    after: list[float] = field(default_factory=list)
    missed: list[dict[str, Any]] = field(default_factory=list)


def people(moves: int, seed: int, latency_s: float) -> dict[str, Any]:
    """Moves that people make, one camera after the other, while the cameras turn from preset to preset."""
    rng, found = np.random.default_rng(seed), Found()
    with emulated_watch(lego(yield_s=6.0), 1, seed, _eyes) as running:
        hands = {
            name: Hands(camera.motors, running.site.cameras[0].tolerance_deg)
            for name, camera in running.emulation.cameras.items()
        }
        for camera in running.emulation.cameras.values():
            camera.faults.latency_s = latency_s
        _steps(running, rng, 3)
        for name in cycle(hands):
            if found.moves >= moves:
                break
            _one_move(running, hands[name], name, rng, found)
    return {"latency_s": latency_s, **vars(found)}


def _one_move(running: Emulated, hand: Hands, name: str, rng: np.random.Generator, found: Found) -> None:
    _steps(running, rng, int(rng.integers(1, 4)))
    kind, motors = str(rng.choice(_KINDS)), running.emulation.cameras[name].motors
    at_s = running.clock.now() + float(rng.uniform(0.0, STEP_S))
    pan, tilt, zoom = motors._journey.goal
    if kind == "jump":
        hand.turn(at_s, (float(rng.uniform(-80, 80)), float(rng.uniform(-80, -10)), zoom))
    elif kind == "preset":
        preset = rng.choice(np.array([(one.pan, one.tilt, one.zoom) for one in running.site.cameras[0].presets]))
        hand.turn(at_s, tuple(preset.tolist()))
    else:
        speed = rng.uniform(-20, 20, size=2)
        for passed in np.arange(0.0, _DRAG_S, _DRAG_EVERY_S).tolist():
            at = float(np.clip(tilt + speed[1] * passed, -89, 29))
            hand.turn(at_s + passed, (float(np.clip(pan + speed[0] * passed, -169, 169)), at, zoom))
    found.moves += 1
    held_s, free_s = None, math.inf
    for _ in range(8):
        held = name in _steps(running, rng, 1)
        held_s = running.clock.now() if held and held_s is None else held_s
        free_s = min(free_s, math.inf if held or held_s is None else running.clock.now())
    if hand.readable_s is not None:
        found.readable += 1
        commands = [one for one in hand.commands if hand.readable_s < one < free_s - STEP_S]
        if held_s is not None and held_s - hand.readable_s <= STEP_S + 0.5 and not commands:
            found.yielded += 1
            found.after.append(round(held_s - hand.readable_s, 3))
        else:
            found.missed.append({"kind": kind, "held_s": held_s, "readable_s": hand.readable_s, "commands": commands})
    for _ in range(20):
        if name not in _steps(running, rng, 1):
            break
    hand.forget()


def _steps(running: Emulated, rng: np.random.Generator, number: int) -> frozenset[str]:
    held: frozenset[str] = frozenset()
    for _ in range(number):
        presets = {name: str(rng.choice(["left", "middle", "right"])) for name in running.emulation.cameras}
        running.world.move(presets)
        held = running.world.observe().held
    return held


def alone(steps: int, seed: int, names: tuple[str, ...]) -> dict[str, Any]:
    """Faults of one camera that come and go, and nobody near."""
    rng = np.random.default_rng(seed)
    with emulated_watch(lego(), 1, seed, _eyes) as running:
        camera = str(rng.choice(list(running.emulation.cameras)))
        hand = Hands(running.emulation.cameras[camera].motors, running.site.cameras[0].tolerance_deg)

        def late(faults: object, on: bool) -> None:
            hand.late((lambda: float(rng.uniform(0.2, 3.0))) if on else None)

        faults = [late if name == "late moves" else FAULTS[name] for name in names]
        held, lost = 0, 0
        for step in campaign(running, steps, camera, faults, rng):
            held += bool(step.sighting.held)
            lost += step.sighting.views[camera] is None
    return {"faults": "+".join(names), "held": held, "lost": lost}


def main(words: list[str]) -> None:
    what, number, seed, *rest = words
    for one in rest:
        found = (
            people(int(number), int(seed), float(one))
            if what == "people"
            else alone(int(number), int(seed), tuple(one.split("+")))
        )
        print(json.dumps(found), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
