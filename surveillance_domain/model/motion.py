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

Cost: O(cells * directions^2 * speeds) time and memory.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.motion_direction import direction_table, speed_table
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
    direction : (directions, directions) or (cells, speeds, directions, directions) float
        P(d'|d) as ``[d, d']``, or P(d'|d,l,v') as ``[l, v', d, d']``.
    direction_scope : {"direction", "cell+speed+direction"}
        Which of the two ``direction`` is.
    location : LocationTable
        P(l'|l,d',v') by its entries.
    """

    speed: Float[np.ndarray, "speeds speeds"]
    direction: Float[np.ndarray, "directions directions"] | Float[np.ndarray, "cells speeds directions directions"]
    direction_scope: DirectionScope
    location: LocationTable


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
        With ``direction_scope`` "direction" for the wall variant ``stay``, "cell+speed+direction" for the others.

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
    return MotionTables(
        speed=speed_table(parameters.speeds_mps, parameters.sigma_speed_mps),
        direction=direction,
        direction_scope=scope,
        location=location_table(grid, parameters, moves),
    )
