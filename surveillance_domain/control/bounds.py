"""What no controller passes: full information, and clairvoyance (the design's page on baselines and bounds).

``full-information`` knows the true states and chooses exactly for the next step. In expectation, under the true motion model
and where any preset is reachable in one step, it bounds every controller. ``clairvoyant`` knows the whole trajectories and
chooses the best presets in hindsight, by dynamic programming over reachable joint presets; it bounds everything with perfect eyes
and working cameras, and is looser.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.control.base import Choice
from surveillance_domain.control.point_estimates import PointEstimates, PointPlanner
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.reachability import reachable
from surveillance_domain.model.views import Views
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.truth import Truth

__all__ = ["ClairvoyantController", "FullInformationController"]

_MOST_JOINT_PRESETS = 20_000


class FullInformationController:
    """Knows where every target is and where it is heading.

    Parameters
    ----------
    truth : callable
        Gives the true states now.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        site = surveillance.site
        self._planner = PointPlanner(surveillance)
        self._estimates = PointEstimates(len(surveillance.targets), site.targets.directions, len(site.targets.speeds_mps))

    def choose(self) -> Choice:
        truth = self._truth()
        self._estimates.cells = truth.cells
        self._estimates.headings = np.eye(self._estimates.headings.shape[1])[truth.directions]
        self._estimates.paces = np.eye(self._estimates.paces.shape[1])[truth.speeds]
        return self._planner.choose(self._estimates)

    def see(self, sighting: Sighting) -> None:
        self._planner.turned(sighting.views)


class ClairvoyantController:
    """Knows what every target will do.

    Parameters
    ----------
    cells : (steps, targets) int
        True cells after each step.

    Raises
    ------
    ValueError
        If there are more than 20,000 joint presets.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, cells: Int[np.ndarray, "steps targets"]) -> None:
        site = surveillance.site
        self._cameras = site.cameras
        sizes = [len(camera.presets) for camera in site.cameras]
        if math.prod(sizes) > _MOST_JOINT_PRESETS:
            raise ValueError(
                f"clairvoyant looks at every joint preset; {math.prod(sizes):,} at site {site.name} are more than "
                f"{_MOST_JOINT_PRESETS:,}"
            )
        self._joint = list(itertools.product(*(range(size) for size in sizes)))
        reach = [reachable(camera, site.control.step_s) for camera in site.cameras]
        self._plan = _best_path(_worth(surveillance.views, self._joint, cells), _joint_reach(reach))
        self._time = 0

    def choose(self) -> Choice:
        presets = self._joint[self._plan[self._time]]
        named = {c.name: c.presets[p].name for c, p in zip(self._cameras, presets, strict=True)}
        return Choice(named, method="dynamic programming in hindsight")

    def see(self, sighting: Sighting) -> None:
        self._time += 1


def _worth(
    views: Views, joint: list[tuple[int, ...]], cells: Int[np.ndarray, "steps targets"]
) -> Float[np.ndarray, "steps joint"]:
    """Expected number of targets observed at each step by each joint preset."""
    return np.stack([views.seen(presets)[cells].sum(axis=1) for presets in joint], axis=1)


def _joint_reach(reach: list[Bool[np.ndarray, "_presets _presets"]]) -> list[Bool[np.ndarray, "_presets _presets"]] | None:
    """Per camera, or ``None`` where every preset reaches every other."""
    return None if all(one.all() for one in reach) else reach


def _best_path(worth: Float[np.ndarray, "steps joint"], reach: list[np.ndarray] | None) -> list[int]:
    """Joint presets, step by step, with the largest sum; all cameras start at their first preset.

    The best value to come is propagated camera by camera, so a step costs joint presets times presets, not their square.
    """
    if reach is None:
        return [int(step.argmax()) for step in worth]
    sizes = [len(one) for one in reach]
    to_come = np.zeros(worth.shape[1])
    ahead = []
    for step in reversed(worth):
        ahead.append(step + to_come)
        best = ahead[-1].reshape(sizes)
        for axis, one in enumerate(reach):
            moved = np.moveaxis(best, axis, -1)
            best = np.moveaxis(np.where(one, moved[..., None, :], -np.inf).max(axis=-1), -1, axis)
        to_come = best.ravel()
    path, present = [], (0,) * len(sizes)
    for values in reversed(ahead):
        options = values.reshape(sizes)[np.ix_(*(np.flatnonzero(one[now]) for one, now in zip(reach, present, strict=True)))]
        index = np.unravel_index(int(options.argmax()), options.shape)
        present = tuple(
            int(np.flatnonzero(one[now])[i]) for one, now, i in zip(reach, present, index, strict=True)
        )
        path.append(int(np.ravel_multi_index(present, sizes)))
    return path
