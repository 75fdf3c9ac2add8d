"""MP and MSP: the paper's comparison with a controller that takes estimates for the truth (sec. expdis).

MP has PTZ cameras only; a target out of sight is dropped, and its direction is that between its last two sightings. MSP adds
static wide-view cameras, which see all that nothing hides, with noise; a PTZ sighting is preferred to theirs.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from surveillance_domain.control.base import Choice
from surveillance_domain.control.point_estimates import PointEstimates, PointPlanner
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import Cell, Sighting

__all__ = ["MdpController", "OutOfSight"]

OutOfSight = Literal["drop", "hold", "dead-reckoning"]
"""What becomes of a target that nobody sees: forgotten, left where it was, or carried on along its heading."""


class MdpController:
    """Point estimates from the last sightings, and the best presets for them.

    Parameters
    ----------
    static : bool
        Whether static cameras help (MSP).
    out_of_sight : OutOfSight
    """

    restarts = 0

    def __init__(self, surveillance: Surveillance, static: bool = False, out_of_sight: OutOfSight = "drop") -> None:
        site = surveillance.site
        if static and not site.static_cameras:
            raise ValueError(f"site {site.name} has no [[static_cameras]], which the controller msp needs")
        self._static, self._out_of_sight = static, out_of_sight
        self._targets, self._grid = surveillance.targets, site.grid
        self._speeds = np.asarray(site.targets.speeds_mps)
        self._step_s = site.control.step_s
        self._planner = PointPlanner(surveillance)
        self._estimates = PointEstimates(len(self._targets), site.targets.directions, len(self._speeds))
        self._last: dict[str, tuple[float, Cell]] = {}

    def choose(self) -> Choice:
        return self._planner.choose(self._estimates)

    def see(self, sighting: Sighting) -> None:
        carried = None
        if self._out_of_sight == "dead-reckoning":
            carried = self._planner.predicted(self._estimates)
        for number, target in enumerate(self._targets):
            cell = sighting.observations[target]
            if cell is None and self._static:
                cell = sighting.static.get(target)
            if cell is not None:
                self._place(number, target, cell, sighting.time_s)
            elif self._out_of_sight == "drop":
                self._estimates.cells[number] = -1
            elif carried is not None and self._estimates.cells[number] >= 0:
                self._carry(number, carried[..., number])
        self._planner.turned(sighting.views)

    def _place(self, number: int, target: str, cell: Cell, time_s: float) -> None:
        """A sighting; the one before it gives direction and speed. Seen twice in one cell: both stay as they were."""
        self._estimates.cells[number] = self._grid.number[cell[1], cell[0]]
        if target in self._last:
            before_s, before = self._last[target]
            dx, dy = cell[0] - before[0], cell[1] - before[1]
            if dx or dy:
                directions = self._estimates.headings.shape[1]
                heading = round(math.atan2(dy, dx) * directions / math.tau) % directions
                self._estimates.headings[number] = np.arange(directions) == heading
            pace = math.hypot(dx, dy) * self._grid.cell_m / (time_s - before_s)
            nearest = int(np.abs(self._speeds - pace).argmin())
            self._estimates.paces[number] = np.arange(len(self._speeds)) == nearest
        self._last[target] = (time_s, cell)

    def _carry(self, number: int, predicted: np.ndarray) -> None:
        """Dead reckoning: on to the likeliest cell, and the likeliest heading there."""
        cell, heading, pace = np.unravel_index(int(predicted.argmax()), predicted.shape)
        self._estimates.cells[number] = cell
        self._estimates.headings[number] = np.arange(predicted.shape[1]) == heading
        self._estimates.paces[number] = np.arange(predicted.shape[2]) == pace
