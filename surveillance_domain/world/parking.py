"""Sending cameras home; people come first."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from surveillance_domain.cameras.base import Camera, Outcome, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraError
from surveillance_domain.cameras.witness import MOVED
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.site.camera import Preset
from surveillance_domain.site.site import Site
from surveillance_domain.world.memory import Memory, Stood, still_for_s
from surveillance_domain.world.yielding import HELD, watching

__all__ = ["Parked", "parked", "sent_home"]

_STILL_S = 1.0
_BUDGET_S = 5.0


@dataclass(frozen=True)
class Parked:
    """What became of a camera.

    Attributes
    ----------
    ok : bool
        Whether it is home, or was rightly left alone.
    told : str
    """

    ok: bool
    told: str


def parked(
    site: Site,
    cameras: Sequence[Camera],
    clock: Clock,
    held: Collection[str],
    memories: Mapping[str, Memory] | None = None,
    killed: Collection[str] = (),
) -> dict[str, Parked]:
    """Send every camera home that nobody holds or turns, or turned in the last ``yield_s``.

    A camera that still turns may do so by the last command of a run that was killed; so it is given its
    ``move_deadline_s`` to come to rest. If that is at none of its presets, no run has sent it there.

    Parameters
    ----------
    memories : dict, optional
        Of the cameras, by name: who was moved by somebody before, and is now.
    killed : collection of str
        Cameras whose run was killed, and may not have seen any more that somebody moved them: those that stand at none
        of their presets are left alone, too.
    """
    known = memories or {}
    yield_s = site.operation.yield_s
    tasks = [
        partial(_park, camera, one, clock, held, known.get(one.name, Memory()), yield_s, one.name in killed)
        for camera, one in zip(cameras, site.cameras, strict=True)
    ]
    with ThreadPoolExecutor(len(tasks)) as pool:
        done = clock.together(pool, tasks)
    return {one.name: future.result() for one, future in zip(site.cameras, done, strict=True)}


def _park(
    camera: Camera,
    description: CameraDescription,
    clock: Clock,
    held: Collection[str],
    memory: Memory,
    yield_s: float,
    killed: bool,
) -> Parked:
    if description.name in held:
        return Parked(True, f"left alone: {HELD}")
    try:
        if description.home is not None:
            because = _in_hands(camera, description, clock, memory, yield_s, killed)
            if because:
                return Parked(True, f"left alone: {because}")
        camera.watched_by(watching(description, math.inf, memory))
    except CameraError as problem:
        return Parked(False, str(problem))
    return sent_home(camera, description)


def sent_home(camera: Camera, description: CameraDescription) -> Parked:
    """Send a camera to its ``home`` preset, if it has one and nobody else moves it, within its ``move_deadline_s``."""
    homes = [_position(one) for one in description.presets if one.name == description.home]
    if not homes:
        return Parked(True, "has no home preset")
    move = camera.move(homes[0], description.move_deadline_s)
    if move.outcome is Outcome.REACHED:
        return Parked(True, f'at "{description.home}"')
    if move.because == MOVED:
        return Parked(True, f"left alone: {MOVED}")
    return Parked(False, f"{move.outcome}: {move.because}")


def _in_hands(
    camera: Camera, description: CameraDescription, clock: Clock, memory: Memory, yield_s: float, killed: bool
) -> str:
    """Why a camera is somebody's; empty if it is not."""
    here = camera.position(_BUDGET_S)
    still_s = still_for_s(memory, yield_s, description.tolerance_deg, here)
    if still_s is not None:
        return f"{MOVED} {still_s:.0f} s ago"
    until, suspect = clock.now() + description.move_deadline_s, killed
    while True:
        clock.sleep(_STILL_S)
        now = camera.position(_BUDGET_S)
        if now.agrees(here, description.tolerance_deg):
            if not suspect or any(now.agrees(_position(one), description.tolerance_deg) for one in description.presets):
                return ""
            memory.keep(Stood(now, 0.0))
            return f"{MOVED} just now"
        if clock.now() >= until:
            memory.keep(Stood(now, 0.0))
            return "somebody else turns it"
        here, suspect = now, True


def _position(preset: Preset) -> Position:
    return Position(preset.pan, preset.tilt, preset.zoom)
