"""Sending cameras home; people come first."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

from surveillance_domain.cameras.base import Camera, Outcome, Position
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraError
from surveillance_domain.cameras.witness import MOVED
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.site.site import Site
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


def parked(site: Site, cameras: Sequence[Camera], clock: Clock, held: Collection[str]) -> dict[str, Parked]:
    """Send every camera home that nobody holds or turns.

    A camera that still turns may do so by the last command of a run that was killed; so it is given its
    ``move_deadline_s`` to come to rest.
    """
    tasks = [partial(_park, camera, one, clock, held) for camera, one in zip(cameras, site.cameras, strict=True)]
    with ThreadPoolExecutor(len(tasks)) as pool:
        done = clock.together(pool, tasks)
    return {one.name: future.result() for one, future in zip(site.cameras, done, strict=True)}


def _park(camera: Camera, description: CameraDescription, clock: Clock, held: Collection[str]) -> Parked:
    if description.name in held:
        return Parked(True, f"left alone: {HELD}")
    try:
        if description.home is not None and not _comes_to_rest(camera, description, clock):
            return Parked(True, "left alone: somebody else turns it")
        camera.watched_by(watching(description, yield_s=math.inf))
    except CameraError as problem:
        return Parked(False, str(problem))
    return sent_home(camera, description)


def sent_home(camera: Camera, description: CameraDescription) -> Parked:
    """Send a camera to its ``home`` preset, if it has one and nobody else moves it, within its ``move_deadline_s``."""
    homes = [Position(one.pan, one.tilt, one.zoom) for one in description.presets if one.name == description.home]
    if not homes:
        return Parked(True, "has no home preset")
    move = camera.move(homes[0], description.move_deadline_s)
    if move.outcome is Outcome.REACHED:
        return Parked(True, f'at "{description.home}"')
    if move.because == MOVED:
        return Parked(True, f"left alone: {MOVED}")
    return Parked(False, f"{move.outcome}: {move.because}")


def _comes_to_rest(camera: Camera, description: CameraDescription, clock: Clock) -> bool:
    until = clock.now() + description.move_deadline_s
    before = camera.position(_BUDGET_S)
    while True:
        clock.sleep(_STILL_S)
        now = camera.position(_BUDGET_S)
        if now.agrees(before, description.tolerance_deg):
            return True
        if clock.now() >= until:
            return False
        before = now
