"""The motion of a target on the grid: three conditional distributions whose product is its transition.

Source: eq:targettransmodel, P(t'|t) = P(l'|l,d',v') P(d'|d) P(v'|v). The paper is silent about walls. Where these
make the direction depend on the place (``reject``, ``reflect``) the transition stays a product,

    P(t'|t) = P(v'|v) P(d'|d,l,v') P(l'|l,d',v').

The variants, for a move being a pair (d', l') whose path is the segment between the two cells' centres:

``reject``
    moves that walls forbid are taken out and the rest is renormalised over all pairs (d', l');
``reflect``
    a direction that is blocked outright is mirrored on the wall, then the location is renormalised over what is open;
``stay``
    the direction knows nothing of walls, and forbidden moves leave the target where it is.

Where there are doors, "outside" is one more place, with the number after the last free cell's
(`surveillance_domain.model.motion_doors`).

Cost: O(cells * directions^2 * speeds) time and memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.motion_direction import direction_table, speed_table
from surveillance_domain.model.motion_doors import Entering, entering, steps_of_a_visit
from surveillance_domain.model.motion_location import LocationTable, location_table, open_move_shares
from surveillance_domain.model.motion_turning import reflected_directions, rejected_directions
from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid

__all__ = ["LocationTable", "MotionParameters", "MotionTables", "motion_tables"]

DirectionScope = Literal["direction", "cell+speed+direction"]


@dataclass(frozen=True, eq=False)
class MotionTables:
    """The conditional distributions of eq:targettransmodel on a grid.

    Attributes
    ----------
    speed : (speeds, speeds) float
        P(v'|v) as ``[v, v']``.
    direction : (directions, directions) or (places, speeds, directions, directions) float
        P(d'|d) as ``[d, d']``, or P(d'|d,l,v') as ``[l, v', d, d']``; places are the cells, and outside.
    direction_scope : {"direction", "cell+speed+direction"}
        Which of the two ``direction`` is.
    location : LocationTable
        P(l'|l,d',v') by its entries.
    outside_share : float or None
        Share of the time, in the long run, that a target is outside, visits beginning with each speed equally often;
        ``None`` without doors.
    """

    speed: Float[np.ndarray, "speeds speeds"]
    direction: Float[np.ndarray, "directions directions"] | Float[np.ndarray, "places speeds directions directions"]
    direction_scope: DirectionScope
    location: LocationTable
    outside_share: float | None = None


def motion_tables(grid: Grid, parameters: MotionParameters) -> MotionTables:
    """Build P(v'|v), P(d'|d,l,v') and P(l'|l,d',v') of eq:targettransmodel for a map.

    Parameters
    ----------
    grid : Grid
        The map; a speed makes v * step_s / cell_m cells a step.
    parameters : MotionParameters

    Returns
    -------
    MotionTables
        With ``direction_scope`` "direction" for the wall variant ``stay`` without doors, "cell+speed+direction" for
        all others.

    Raises
    ------
    ValueError
        If the grid has no free cell.
    """
    if grid.size == 0:
        raise ValueError("the grid has no free cell: targets have nowhere to be; free at least one cell of the map")
    plain = direction_table(parameters.directions, parameters.sigma_direction_deg)
    moves = open_move_shares(grid, parameters)
    scope: DirectionScope = "cell+speed+direction"
    if parameters.walls == "stay":
        direction, scope = plain, "direction"
    elif parameters.walls == "reject":
        direction = rejected_directions(plain, moves)
    else:
        direction = reflected_directions(plain, moves)
    speed = speed_table(parameters.speeds_mps, parameters.sigma_speed_mps)
    location = location_table(grid, parameters, moves)
    if not parameters.doors:
        return MotionTables(speed, direction, scope, location)
    way_in = entering(grid, parameters, moves.on_map)
    return _with_outside(speed, np.broadcast_to(direction, (*moves.on_map.shape, len(plain))), location, way_in)


def _with_outside(
    speed: Float[np.ndarray, "speeds speeds"],
    direction: Float[np.ndarray, "cells speeds directions directions"],
    location: LocationTable,
    way_in: Entering,
) -> MotionTables:
    """The tables with one more place, where targets are that left by a door."""
    outside, directions = len(direction), direction.shape[-1]
    on_entering = np.broadcast_to(way_in.directions[:, None], (len(speed), directions, directions))
    direction = np.concatenate([direction, on_entering[None]])
    start = np.zeros((outside, len(speed), directions))
    np.add.at(start, way_in.cells, way_in.joint / len(speed))
    location = _with_entries(location, way_in, outside)
    keys = (location.cell, location.direction, location.speed, location.next_cell)
    steps = steps_of_a_visit(start, speed, direction, keys, location.probability)
    share = 0.0 if way_in.probability == 0 else 1 / (1 + way_in.probability * steps)
    return MotionTables(speed, direction, "cell+speed+direction", location, share)


def _with_entries(location: LocationTable, way_in: Entering, outside: int) -> LocationTable:
    """P(l'|outside,d',v'): in at a door cell, as its share of the direction has it, or not."""
    of_direction = way_in.directions
    given = way_in.joint / np.where(of_direction > 0, of_direction, 1.0)
    speeds, directions = of_direction.shape
    probability = np.zeros((directions, speeds, outside + 1))
    for number, cell in enumerate(way_in.cells.tolist()):
        probability[:, :, cell] += way_in.probability * given[number].T
    probability[:, :, outside] = np.where(of_direction.T > 0, 1 - way_in.probability, 1.0)
    direction, speed, next_cell = np.nonzero(probability)
    return LocationTable(
        cell=np.concatenate([location.cell, np.full(len(direction), outside)]),
        direction=np.concatenate([location.direction, direction]),
        speed=np.concatenate([location.speed, speed]),
        next_cell=np.concatenate([location.next_cell, next_cell]),
        probability=np.concatenate([location.probability, probability[direction, speed, next_cell]]),
    )
