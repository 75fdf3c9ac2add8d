"""Doors: how targets leave the map and come back (model.md, "Doors").

The map has one more place, *outside*, with the number after the last free cell. A move whose path leaves the map from a
door cell, all cells before being free, leads there. A target that is outside enters in a step with probability
1 - exp(-Λ step_s), Λ being the sum of the doors' rates; by door j with the share of its rate, in each of its cells with
the same probability, and there in a direction d' with probability proportional to the share of its moves at v' that are
open and stay on the map (in every direction, where none is). While it is outside its direction is drawn anew in every
step from what it would be on entering, and its speed changes as ever.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.model.motion_walls import path_of
from surveillance_domain.model.parameters import DoorParameters, MotionParameters
from surveillance_domain.site.grid import Grid

__all__ = ["Entering", "entering", "leaves_by_door", "steps_of_a_visit"]

_MOST_STEPS = 10_000
_SETTLED = 1e-6
_STEADY = 8


@dataclass(frozen=True, eq=False)
class Entering:
    """How a target comes in.

    Attributes
    ----------
    probability : float
        Of entering within one step.
    cells : (entries,) int
        Numbers of the door cells.
    joint : (entries, speeds, directions) float
        P(cell, direction | speed, entering); sums to one over cells and directions.
    """

    probability: float
    cells: Int[np.ndarray, " entries"]
    joint: Float[np.ndarray, "entries speeds directions"]

    @property
    def directions(self) -> Float[np.ndarray, "speeds directions"]:
        """P(d' | v', entering)."""
        return self.joint.sum(axis=0)


def leaves_by_door(grid: Grid, doors: Sequence[DoorParameters], dx: int, dy: int) -> Bool[np.ndarray, " cells"]:
    """From which free cells the move by (dx, dy) cells leaves the map from a door cell.

    A corner point on the way is passed as between cells; on the way out of the door nothing stands beside it.
    """
    is_door = np.zeros_like(grid.free)
    for door in doors:
        for column, row in door.cells:
            is_door[row, column] = True
    on_map = np.ones_like(grid.free)
    under_way = np.ones(grid.size, dtype=bool)
    gone = np.zeros(grid.size, dtype=bool)
    before = (0, 0)
    for cell in path_of(dx, dy).cells:
        inside = _at(on_map, grid.cells, cell)
        gone |= under_way & ~inside & _at(is_door, grid.cells, before)
        under_way &= inside & _at(grid.free, grid.cells, cell)
        if cell[0] != before[0] and cell[1] != before[1]:
            sides = (cell[0], before[1]), (before[0], cell[1])
            under_way &= _at(grid.free, grid.cells, sides[0]) | _at(grid.free, grid.cells, sides[1])
        before = cell
    return gone


def _at(
    mask: Bool[np.ndarray, "rows columns"], cells: Int[np.ndarray, "cells 2"], offset: tuple[int, int]
) -> Bool[np.ndarray, " cells"]:
    """The mask at an offset from every cell; False outside of the map."""
    column, row = cells[:, 0] + offset[0], cells[:, 1] + offset[1]
    inside = (column >= 0) & (column < mask.shape[1]) & (row >= 0) & (row < mask.shape[0])
    return inside & mask[np.where(inside, row, 0), np.where(inside, column, 0)]


def entering(
    grid: Grid, parameters: MotionParameters, on_map: Float[np.ndarray, "cells speeds directions"]
) -> Entering:
    """How targets come in through the doors.

    Parameters
    ----------
    grid : Grid
    parameters : MotionParameters
        With at least one door.
    on_map : (cells, speeds, directions) float
        Share of each heading's moves that is open and stays on the map.
    """
    total = sum(door.rate_per_s for door in parameters.doors)
    cells, shares = [], []
    for door in parameters.doors:
        of_door = door.rate_per_s / total if total > 0 else 1 / len(parameters.doors)
        for column, row in door.cells:
            cells.append(int(grid.number[row, column]))
            shares.append(of_door / len(door.cells))
    weight = on_map[cells].copy()
    weight[~(weight > 0).any(axis=2)] = 1.0
    weight /= weight.sum(axis=2, keepdims=True)
    joint = np.array(shares)[:, None, None] * weight
    return Entering(-math.expm1(-total * parameters.step_s), np.array(cells), joint)


def steps_of_a_visit(
    start: Float[np.ndarray, "cells speeds directions"],
    speed: Float[np.ndarray, "speeds speeds"],
    direction: Float[np.ndarray, "places speeds directions directions"],
    location: tuple[Int[np.ndarray, " entries"], ...],
    probability: Float[np.ndarray, " entries"],
) -> float:
    """Mean number of steps from coming in to going out; infinite where targets cannot go out.

    The mass that is still inside is summed step by step until it falls at a steady rate; the rest is that geometric
    series.

    Parameters
    ----------
    start : (cells, speeds, directions) float
        Where a visit begins; sums to one.
    speed, direction
        P(v'|v) and P(d'|d,l,v'), the last place being outside.
    location : tuple of (entries,) int
        l, d', v' and l' of the entries of P(l'|l,d',v').
    probability : (entries,) float
    """
    here = start
    cells = len(start)
    steps, ratio, steady = 1.0, 0.0, 0
    place, heading, pace, end = location
    inside = (place < cells) & (end < cells)
    place, heading, pace, end, share = place[inside], heading[inside], pace[inside], end[inside], probability[inside]
    flat_end = (end * start.shape[1] + pace) * start.shape[2] + heading
    for _ in range(_MOST_STEPS):
        mass = float(here.sum())
        faster = np.einsum("lvd,vw->lwd", here, speed)
        turned = np.einsum("lwd,lwde->lwe", faster, direction[:cells])
        moved = np.bincount(flat_end, weights=turned[place, pace, heading] * share, minlength=start.size)
        here = moved.reshape(start.shape)
        left = float(here.sum())
        if left <= _SETTLED:
            return steps + left
        steps, before, ratio = steps + left, ratio, left / mass
        steady = steady + 1 if abs(ratio - before) < _SETTLED * (1 - ratio) else 0
        if steady == _STEADY:
            break
    return math.inf if ratio > 1 - 1e-9 else steps + left * ratio / (1 - ratio)
