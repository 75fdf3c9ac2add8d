"""MP and MSP: the paper's comparison with a controller that takes estimates for the truth (sec. expdis).

MP has PTZ cameras only; a target out of sight is dropped, and its direction is that between its last two sightings. MSP
adds static wide-view cameras, which see all that nothing hides, with noise; a PTZ sighting is preferred to theirs.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from surveillance_domain.control.base import Choice
from surveillance_domain.control.point_estimates import PointEstimates, PointPlanner
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.motion_walls import path_of
from surveillance_domain.world.base import Cell, Sighting

__all__ = ["MdpController", "OutOfSight"]

OutOfSight = Literal["drop", "hold", "dead-reckoning"]
"""What becomes of a target that nobody sees: dropped, left where it was, or carried on along its heading to a wall."""


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
        self._planner = PointPlanner(surveillance)
        self._estimates = PointEstimates(len(self._targets), site.targets.directions, len(self._speeds))
        self._last: dict[str, tuple[float, Cell]] = {}

    def choose(self) -> Choice:
        return self._planner.choose(self._estimates)

    def see(self, sighting: Sighting) -> None:
        for number, target in enumerate(self._targets):
            cell = sighting.observations[target]
            if cell is None and self._static:
                cell = sighting.static.get(target)
            if cell is not None:
                self._place(number, target, cell, sighting.time_s)
            elif self._out_of_sight == "drop":
                self._estimates.cells[number] = -1
            elif self._out_of_sight == "dead-reckoning" and self._estimates.cells[number] >= 0:
                self._carry(number, target, sighting.time_s)
        self._planner.turned(sighting)

    def _place(self, number: int, target: str, cell: Cell, time_s: float) -> None:
        """A sighting; the one before it gives direction and speed. Seen twice in one cell: the direction stays."""
        self._estimates.cells[number] = self._grid.number[cell[1], cell[0]]
        before_s, before = self._last.get(target, (time_s, cell))
        self._last[target] = (time_s, cell)
        if time_s <= before_s:
            return
        dx, dy = cell[0] - before[0], cell[1] - before[1]
        if dx or dy:
            directions = self._estimates.headings.shape[1]
            heading = round(math.atan2(dy, dx) * directions / math.tau) % directions
            self._estimates.headings[number] = np.arange(directions) == heading
        pace = math.hypot(dx, dy) * self._grid.cell_m / (time_s - before_s)
        nearest = int(np.abs(self._speeds - pace).argmin())
        self._estimates.paces[number] = np.arange(len(self._speeds)) == nearest

    def _carry(self, number: int, target: str, time_s: float) -> None:
        """Dead reckoning: straight on from the last sighting as far as the way is free; without a heading it stays."""
        heading, pace = self._estimates.headings[number], self._estimates.paces[number]
        if heading.max() < 1 or pace.max() < 1:
            return
        seen_s, seen = self._last[target]
        length = float(self._speeds[pace.argmax()]) * (time_s - seen_s) / self._grid.cell_m
        angle = math.tau * int(heading.argmax()) / len(heading)
        column, row = (int(part) for part in self._grid.cells[self._estimates.cells[number]])
        dx, dy = seen[0] + length * math.cos(angle) - column, seen[1] + length * math.sin(angle) - row
        self._estimates.cells[number] = self._reached(column, row, math.floor(dx + 0.5), math.floor(dy + 0.5))

    def _reached(self, column: int, row: int, dx: int, dy: int) -> int:
        """Number of the last free cell on the way from a cell to that at (dx, dy) from it."""
        reached = column, row
        for along, up in path_of(dx, dy).cells:
            x, y = column + along, row + up
            if not (0 <= x < self._grid.columns and 0 <= y < self._grid.rows and self._grid.free[y, x]):
                break
            reached = x, y
        return int(self._grid.number[reached[1], reached[0]])
