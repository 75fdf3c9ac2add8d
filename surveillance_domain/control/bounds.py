"""What no controller passes: full information, and clairvoyance (the design's page on baselines and bounds).

``full-information`` knows the true states and chooses exactly for the next step. In expectation, under the true motion
model and where any preset is reachable in one step, it bounds every controller (where targets come and go: in the
number of targets observed, rather than in PercentObs). ``clairvoyant`` knows the whole trajectories and chooses the
best presets in hindsight, by dynamic programming over reachable joint presets; it bounds everything with perfect eyes
and working cameras, and is looser.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np
from jaxtyping import Bool, Float, Int

from solvers.maximise import ENUMERATED
from surveillance_domain.control.base import Choice
from surveillance_domain.control.point_estimates import PointEstimates, PointPlanner
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.reachability import reachable
from surveillance_domain.model.views import Views
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.truth import OUTSIDE, Truth

__all__ = ["ClairvoyantController", "FullInformationController", "best_path"]

_MOST_JOINT_PRESETS = 20_000
_TIE = 1e-9


class FullInformationController:
    """Knows where every target is and where it is heading.

    Parameters
    ----------
    truth : callable
        Gives the true states now.

    Raises
    ------
    ValueError
        If there are more joint presets than can be looked at one by one: a choice that is not exact is no bound.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, truth: Callable[[], Truth]) -> None:
        self._truth = truth
        site = surveillance.site
        _refuse_too_many("full-information", surveillance, ENUMERATED)
        self._planner = PointPlanner(surveillance)
        directions, speeds = site.targets.directions, len(site.targets.speeds_mps)
        self._outside = site.grid.size if site.targets.doors else -1
        self._estimates = PointEstimates(len(surveillance.targets), directions, speeds)

    def choose(self) -> Choice:
        truth = self._truth()
        self._estimates.cells = np.where(truth.cells == OUTSIDE, self._outside, truth.cells)
        self._estimates.headings = np.eye(self._estimates.headings.shape[1])[truth.directions]
        self._estimates.paces = np.eye(self._estimates.paces.shape[1])[truth.speeds]
        return self._planner.choose(self._estimates)

    def see(self, sighting: Sighting) -> None:
        self._planner.turned(sighting)


class ClairvoyantController:
    """Knows what every target will do.

    Parameters
    ----------
    cells : (steps, targets) int
        True cells after each step, or `OUTSIDE`.

    Raises
    ------
    ValueError
        If there are more than 20,000 joint presets.
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, cells: Int[np.ndarray, "steps targets"]) -> None:
        site = surveillance.site
        self._cameras = site.cameras
        _refuse_too_many("clairvoyant", surveillance, _MOST_JOINT_PRESETS)
        self._joint = list(itertools.product(*(range(len(camera.presets)) for camera in site.cameras)))
        reach = [reachable(camera, site.control.step_s) for camera in site.cameras]
        self._plan = best_path(_worth(surveillance.views, self._joint, cells), reach)
        self._time = 0

    def choose(self) -> Choice:
        presets = self._joint[self._plan[self._time]]
        named = {c.name: c.presets[p].name for c, p in zip(self._cameras, presets, strict=True)}
        return Choice(named, method="dynamic programming in hindsight")

    def see(self, sighting: Sighting) -> None:
        self._time += 1


def _refuse_too_many(controller: str, surveillance: Surveillance, most: int) -> None:
    joint = surveillance.model.joint_actions
    if joint > most:
        site = surveillance.site.name
        raise ValueError(f"{controller} looks at every joint preset; {joint:,} at site {site} are more than {most:,}")


def _worth(
    views: Views, joint: list[tuple[int, ...]], cells: Int[np.ndarray, "steps targets"]
) -> Float[np.ndarray, "steps joint"]:
    """Expected number of targets observed at each step by each joint preset.

    Where targets come and go, it is their share of those present: every step counts the same, as in PercentObs.
    """
    inside = cells != OUTSIDE
    passed, index = np.unique(np.where(inside, cells, 0), return_inverse=True)
    there = Views(tuple(detection[:, passed] for detection in views.detection), views.noise_m)
    index = index.reshape(cells.shape)
    worth = np.stack([(there.seen(presets)[index] * inside).sum(axis=1) for presets in joint], axis=1)
    present = inside.sum(axis=1, keepdims=True)
    return worth if inside.all() else worth / np.maximum(present, 1)


def best_path(
    worth: Float[np.ndarray, "steps joint"], reach: Sequence[Bool[np.ndarray, "_presets _presets"]]
) -> list[int]:
    """Joint presets, step by step, with the largest sum of worth; all cameras start at their first preset.

    The best value to come is propagated camera by camera, so a step costs joint presets times presets, not their
    square. Ties (within 1e-9) keep the present presets of as many cameras as possible, then take the first.

    Parameters
    ----------
    worth : (steps, joint) float
        Of every joint preset, the last camera's changing fastest.
    reach : sequence of (presets, presets) bool
        For each camera, which presets it reaches from which within a step.
    """
    sizes = [len(one) for one in reach]
    to_come = np.zeros(worth.shape[1])
    ahead = []
    for step in reversed(worth):
        ahead.append(step + to_come)
        to_come = _best_reachable(ahead[-1].reshape(sizes), reach).ravel()
    places = np.stack(np.unravel_index(np.arange(worth.shape[1]), sizes), axis=1)
    path, present = [], np.zeros(len(sizes), dtype=np.int64)
    for values in reversed(ahead):
        open_to = np.all([one[now, to] for one, now, to in zip(reach, present, places.T, strict=True)], axis=0)
        tied = np.flatnonzero(open_to & (values >= values[open_to].max() - _TIE))
        chosen = int(tied[(places[tied] == present).sum(axis=1).argmax()])
        path.append(chosen)
        present = places[chosen]
    return path


def _best_reachable(
    values: Float[np.ndarray, "..."], reach: Sequence[Bool[np.ndarray, "_presets _presets"]]
) -> Float[np.ndarray, "..."]:
    """The largest value that each joint preset reaches in one step."""
    for axis, one in enumerate(reach):
        moved = np.moveaxis(values, axis, -1)
        values = np.moveaxis(np.where(one, moved[..., None, :], -np.inf).max(axis=-1), -1, axis)
    return values
