"""Location: the cell's square, moved, is shared by the cells that it overlaps; walls take some of these moves away.

Source: P(l'|l,d',v') of eq:targettransmodel. Sharing by area keeps the mean move exact; rounding to the nearest cell
does not (1.5 cells a step would be 2.0 along an axis and 1.41 along a diagonal).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.model.motion_doors import leaves_by_door
from surveillance_domain.model.motion_walls import open_moves
from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid

__all__ = ["STAYING", "LocationTable", "MoveShares", "OpenMoves", "location_table", "move_shares", "open_move_shares"]

Offset = tuple[int, int]
STAYING: Offset = (0, 0)
WHOLE_CELLS_TOLERANCE = 1e-9


@dataclass(frozen=True, eq=False)
class LocationTable:
    """P(l'|l,d',v') by its entries that are not zero; every (l, d', v') has at least one and sums to one.

    Where there are doors, l and l' may be *outside*, the number after the last free cell's. Entries stand in the order
    of cell, direction, speed, next cell, and none stands twice.

    Attributes
    ----------
    cell, direction, speed, next_cell : (entries,) int
        l, d', v' and l', by their numbers.
    probability : (entries,) float
    """

    cell: Int[np.ndarray, "entries"]
    direction: Int[np.ndarray, "entries"]
    speed: Int[np.ndarray, "entries"]
    next_cell: Int[np.ndarray, "entries"]
    probability: Float[np.ndarray, "entries"]


@dataclass(frozen=True)
class MoveShares:
    """One heading at one speed in open space: the moves in whole cells that it falls into, with their shares."""

    offsets: tuple[Offset, ...]
    shares: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class OpenMoves:
    """What the walls leave of every heading's moves.

    Attributes
    ----------
    moves : moves[direction][speed]
        Offsets and shares in open space.
    allowed : offset to (cells,) bool
        From which cells a move in whole cells is open.
    exits : offset to (cells,) bool
        From which cells it leaves the map by a door; empty where there are no doors.
    on_map : (cells, speeds, directions) float
        Share of the heading's moves that is open and stays on the map.
    exit_mass : (cells, speeds, directions) float
        Share that leaves by a door.
    leads_on : (cells, speeds, directions) bool
        Whether a move to another cell, or out of a door, is open.
    """

    moves: tuple[tuple[MoveShares, ...], ...]
    allowed: dict[Offset, Bool[np.ndarray, "cells"]]
    exits: dict[Offset, Bool[np.ndarray, "cells"]]
    on_map: Float[np.ndarray, "cells speeds directions"]
    exit_mass: Float[np.ndarray, "cells speeds directions"]
    leads_on: Bool[np.ndarray, "cells speeds directions"]

    @property
    def open_mass(self) -> Float[np.ndarray, "cells speeds directions"]:
        """Z(l,d',v'): share of the heading's moves that is open."""
        return self.on_map + self.exit_mass


def move_shares(cells_a_step: float, heading_deg: float) -> MoveShares:
    """Share a unit square that is moved by ``cells_a_step`` along ``heading_deg`` by overlapping area.

    Parameters
    ----------
    cells_a_step : float
        Length of the move in cells, v' * step_s / cell_m.
    heading_deg : float
        Degrees counter-clockwise from +x.

    Returns
    -------
    MoveShares
        One to four offsets ``(dx, dy)``, ordered by dy, then dx; the shares sum to one and their mean is the move.
        A component within 1e-9 of a whole number of cells counts as whole.
    """
    along_x = _axis_shares(cells_a_step * math.cos(math.radians(heading_deg)))
    along_y = _axis_shares(cells_a_step * math.sin(math.radians(heading_deg)))
    pairs = [((dx, dy), share_x * share_y) for dy, share_y in along_y for dx, share_x in along_x]
    return MoveShares(tuple(offset for offset, _ in pairs), tuple(share for _, share in pairs))


def _axis_shares(displacement: float) -> list[tuple[int, float]]:
    """Overlap of a unit interval, moved by ``displacement``, with the unit intervals about the integers."""
    whole = round(displacement)
    if abs(displacement - whole) < WHOLE_CELLS_TOLERANCE:
        return [(whole, 1.0)]
    low = math.floor(displacement)
    return [(low, low + 1 - displacement), (low + 1, displacement - low)]


def open_move_shares(grid: Grid, parameters: MotionParameters) -> OpenMoves:
    """Lay every heading's moves over the map."""
    step_cells = [speed * parameters.step_s / grid.cell_m for speed in parameters.speeds_mps]
    headings = [direction * 360.0 / parameters.directions for direction in range(parameters.directions)]
    moves = tuple(tuple(move_shares(length, heading) for length in step_cells) for heading in headings)
    offsets = {offset for by_speed in moves for move in by_speed for offset in move.offsets} | {STAYING}
    allowed = {offset: open_moves(grid.free, *offset)[grid.free] for offset in sorted(offsets)}
    doors = parameters.doors
    exits = {offset: leaves_by_door(grid, doors, *offset) for offset in sorted(offsets)} if doors else {}
    shape = (grid.size, len(step_cells), len(headings))
    on_map, exit_mass, leads_on = np.zeros(shape), np.zeros(shape), np.zeros(shape, dtype=bool)
    for direction, by_speed in enumerate(moves):
        for speed, move in enumerate(by_speed):
            for offset, share in zip(move.offsets, move.shares, strict=True):
                on_map[:, speed, direction] += share * allowed[offset]
                if offset != STAYING:
                    leads_on[:, speed, direction] |= allowed[offset]
                if exits:
                    exit_mass[:, speed, direction] += share * exits[offset]
                    leads_on[:, speed, direction] |= exits[offset]
    return OpenMoves(moves, allowed, exits, on_map, exit_mass, leads_on)


def location_table(grid: Grid, parameters: MotionParameters, moves: OpenMoves) -> LocationTable:
    """P(l'|l,d',v').

    With ``stay`` the share of the moves that are lost stays in the cell. With ``reject`` and ``reflect`` the shares
    that are open are renormalised, share * open / Z(l,d',v'), and where none is open the target stays. A move out of a
    door is open.
    """
    slots = 2 + max(len(move.offsets) for by_speed in moves.moves for move in by_speed)
    shape = (grid.size, parameters.directions, len(parameters.speeds_mps), slots)
    probability, next_cell = np.zeros(shape), np.zeros(shape, dtype=np.int64)
    for direction, by_speed in enumerate(moves.moves):
        for speed, move in enumerate(by_speed):
            share_of = dict(zip(move.offsets, move.shares, strict=True))
            offsets = sorted({*move.offsets, STAYING}, key=lambda offset: (offset[1], offset[0]))
            share = np.array([share_of.get(offset, 0.0) for offset in offsets])
            allowed = np.stack([moves.allowed[offset] for offset in offsets], axis=1)
            kept, own = share * allowed, offsets.index(STAYING)
            lost, ends = ~allowed, [_moved(grid, offset) for offset in offsets]
            if moves.exits:
                leaving = np.stack([moves.exits[offset] for offset in offsets], axis=1)
                kept = np.concatenate([kept, (share * leaving).sum(axis=1, keepdims=True)], axis=1)
                lost = lost & ~leaving
                ends.append(np.full(grid.size, grid.size))
            if parameters.walls == "stay":
                kept[:, own] += (share * lost).sum(axis=1)
            else:
                kept[kept.sum(axis=1) == 0, own] = 1.0
            heading = (slice(None), direction, speed, slice(len(ends)))
            probability[heading] = kept / kept.sum(axis=1, keepdims=True)
            next_cell[heading] = np.stack(ends, axis=1)
    cell, direction_number, speed_number, slot = np.nonzero(probability)
    entries = (cell, direction_number, speed_number, slot)
    return LocationTable(cell, direction_number, speed_number, next_cell[entries], probability[entries])


def _moved(grid: Grid, offset: Offset) -> Int[np.ndarray, "cells"]:
    """Find the cell at ``offset`` from every free cell; of no meaning where that is blocked or outside of the map."""
    column = np.clip(grid.cells[:, 0] + offset[0], 0, grid.columns - 1)
    row = np.clip(grid.cells[:, 1] + offset[1], 0, grid.rows - 1)
    return grid.number[row, column]
