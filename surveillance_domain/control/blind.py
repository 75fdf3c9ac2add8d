"""Sys and Stat: presets that do not depend on what is seen (sec. expdis)."""

from __future__ import annotations

from surveillance_domain.control.base import Choice
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.coverage import best_joint_coverage
from surveillance_domain.model.reachability import reachable
from surveillance_domain.world.base import Sighting

__all__ = ["StaticController", "SystematicController"]


class SystematicController:
    """Sys: every camera pans through its presets, ``t mod |C|``, as fast as it can reach them.

    Parameters
    ----------
    phase : int
        Preset of the first step; results are averaged over phases.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, phase: int = 0) -> None:
        self._cameras = surveillance.site.cameras
        self._reach = [reachable(camera, surveillance.site.control.step_s) for camera in self._cameras]
        self._present = [0] * len(self._cameras)
        self._time = phase

    def choose(self) -> Choice:
        wanted = [self._time % len(camera.presets) for camera in self._cameras]
        steps = zip(self._reach, self._present, wanted, strict=True)
        self._present = [then if reach[now, then] else now for reach, now, then in steps]
        presets = {c.name: c.presets[p].name for c, p in zip(self._cameras, self._present, strict=True)}
        return Choice(presets, method="round robin")

    def see(self, sighting: Sighting) -> None:
        self._time += 1


class StaticController:
    """Stat: the joint preset that covers most of the floor, held for good (reached over several steps if need be)."""

    restarts = 0

    def __init__(self, surveillance: Surveillance) -> None:
        self._cameras = surveillance.site.cameras
        self._reach = [reachable(camera, surveillance.site.control.step_s) for camera in self._cameras]
        self._present = [0] * len(self._cameras)
        self._wanted, self._method = best_joint_coverage(surveillance.views)

    def choose(self) -> Choice:
        steps = zip(self._reach, self._present, self._wanted, strict=True)
        self._present = [_toward(reach, now, then) for reach, now, then in steps]
        presets = {c.name: c.presets[p].name for c, p in zip(self._cameras, self._present, strict=True)}
        return Choice(presets, method=f"{self._method} coverage of the floor")

    def see(self, sighting: Sighting) -> None:
        """Nothing that is seen changes the presets."""


def _toward(reach: object, now: int, then: int) -> int:
    """The first step of a shortest way to a preset; ``now`` if there is no way."""
    from collections import deque

    came_from = {now: now}
    queue = deque([now])
    while queue:
        here = queue.popleft()
        for there in range(len(reach)):  # type: ignore[arg-type]
            if reach[here, there] and there not in came_from:  # type: ignore[index]
                came_from[there] = here
                queue.append(there)
    if then not in came_from:
        return now
    while came_from[then] != now:
        then = came_from[then]
    return then
