"""Sys and Stat: presets that do not depend on what is seen (sec. expdis)."""

from __future__ import annotations

from collections import deque

import numpy as np
from jaxtyping import Bool

from surveillance_domain.control.base import Choice
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.coverage import best_joint_coverage
from surveillance_domain.model.reachability import reachable
from surveillance_domain.world.base import Sighting

__all__ = ["StaticController", "SystematicController"]


class SystematicController:
    """Sys: every camera pans through its presets, one after the other: ``t mod |C|`` where it reaches them in a step.

    Where slew forbids that, a camera goes the shortest way to the next preset in order, over several steps, and then on
    to the one after. A preset that cannot be reached at all is passed over.

    Parameters
    ----------
    phase : int
        Preset of the first step; results are averaged over phases.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, phase: int = 0) -> None:
        self._cameras = _Cameras(surveillance)
        self._wanted = [phase % size for size in self._cameras.sizes]

    def choose(self) -> Choice:
        for camera, size in enumerate(self._cameras.sizes):
            while not self._cameras.can_get(camera, self._wanted[camera]):
                self._wanted[camera] = (self._wanted[camera] + 1) % size
        return Choice(self._cameras.step(self._wanted), method="round robin")

    def see(self, sighting: Sighting) -> None:
        self._cameras.turned(sighting)
        arrived = [now == then for now, then in zip(self._cameras.present, self._wanted, strict=True)]
        after = zip(self._wanted, arrived, self._cameras.sizes, strict=True)
        self._wanted = [(wanted + there) % size for wanted, there, size in after]


class StaticController:
    """Stat: the joint preset that covers most of the floor, held for good (reached over several steps if need be)."""

    restarts = 0

    def __init__(self, surveillance: Surveillance) -> None:
        self._cameras = _Cameras(surveillance)
        self._wanted, how = best_joint_coverage(surveillance.views)
        self._method = f"{how} coverage of the floor"

    def choose(self) -> Choice:
        return Choice(self._cameras.step(list(self._wanted)), method=self._method)

    def see(self, sighting: Sighting) -> None:
        self._cameras.turned(sighting)


class _Cameras:
    """Where the cameras are (one that is away: where it was sent), and the way from there to other presets."""

    def __init__(self, surveillance: Surveillance) -> None:
        self._cameras = surveillance.site.cameras
        self._reach = [reachable(camera, surveillance.site.control.step_s) for camera in self._cameras]
        self.sizes = [len(camera.presets) for camera in self._cameras]
        self.present = [0] * len(self._cameras)

    def can_get(self, camera: int, preset: int) -> bool:
        """Whether there is a way, over however many steps."""
        return _first_step(self._reach[camera], self.present[camera], preset) is not None

    def step(self, wanted: list[int]) -> dict[str, str]:
        """One step of every camera towards a preset; a camera that has no way there stays."""
        ways = zip(self._reach, self.present, wanted, strict=True)
        firsts = [_first_step(reach, now, then) for reach, now, then in ways]
        self.present = [now if first is None else first for now, first in zip(self.present, firsts, strict=True)]
        return {c.name: c.presets[preset].name for c, preset in zip(self._cameras, self.present, strict=True)}

    def turned(self, sighting: Sighting) -> None:
        """Learn where the cameras really are."""
        for number, camera in enumerate(self._cameras):
            view = sighting.views[camera.name]
            if view is not None:
                self.present[number] = [preset.name for preset in camera.presets].index(view)


def _first_step(reach: Bool[np.ndarray, "presets presets"], now: int, then: int) -> int | None:
    """The first step of a shortest way to a preset; ``None`` if there is no way."""
    came_from = {now: now}
    queue = deque([now])
    while queue:
        here = queue.popleft()
        for there in map(int, np.flatnonzero(reach[here])):
            if there not in came_from:
                came_from[there] = here
                queue.append(there)
    if then not in came_from:
        return None
    while came_from[then] != now:
        then = came_from[then]
    return then
