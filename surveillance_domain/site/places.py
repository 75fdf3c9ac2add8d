"""What the places in a site file must hold against its map: cameras outside of walls, doors on free cells."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from surveillance_domain.site.faults import Fault
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.schema import SiteFile

__all__ = ["check_places"]

_FARTHEST_CELLS = 100_000
_EDGE = 1e-4


def check_places(file: SiteFile, grid: Grid) -> tuple[Fault, ...]:
    """Faults of cameras and doors against the map."""
    return tuple(_faults(file, grid))


def _faults(file: SiteFile, grid: Grid) -> Iterator[Fault]:
    for index, camera in enumerate(file.cameras):
        yield from _position_faults(f"cameras[{index}].mount.position_m", camera.mount.position_m, grid)
    for index, static in enumerate(file.static_cameras):
        yield from _position_faults(f"static_cameras[{index}].position_m", static.position_m, grid)
    for door_index, door in enumerate(file.targets.doors):
        for cell_index, (column, row) in enumerate(door.cells):
            where = f"targets.doors[{door_index}].cells[{cell_index}]"
            if column >= grid.columns or row >= grid.rows:
                limits = f"column 0 to {grid.columns - 1}, row 0 to {grid.rows - 1}"
                yield Fault(where, f"[{column}, {row}], outside of the map", limits)
            elif not grid.free[row, column]:
                yield Fault(where, f"[{column}, {row}], a blocked cell", "a free cell [column, row]")
    counts = Counter(cell for door in file.targets.doors for cell in door.cells)
    for cell in (cell for cell, count in counts.items() if count > 1):
        yield Fault("targets.doors", f"the cell {list(cell)} {counts[cell]} times", "each cell in one door, once")


def _position_faults(where: str, position_m: Sequence[float], grid: Grid) -> Iterator[Fault]:
    place = (np.array(position_m[:2]) - np.array(grid.origin_m)) / grid.cell_m
    shown = f"[{position_m[0]:g}, {position_m[1]:g}]"
    if np.any(place < -_FARTHEST_CELLS) or np.any(place > _FARTHEST_CELLS + max(grid.columns, grid.rows)):
        yield Fault(where, shown, f"a place at most {_FARTHEST_CELLS} cells away from the map")
    elif all(_blocked(grid, place + offset) for offset in product((-_EDGE, _EDGE), repeat=2)):
        column, row = np.floor(place).astype(int).tolist()
        found = f"{shown}, inside the blocked cell [{column}, {row}]"
        yield Fault(where, found, "a place in a free cell, on the edge of a wall or outside of the map")


def _blocked(grid: Grid, place: np.ndarray) -> bool:
    """Whether a point, in cells from the map's corner, lies on the map and in a blocked cell."""
    column, row = np.floor(place).astype(int).tolist()
    return 0 <= column < grid.columns and 0 <= row < grid.rows and not grid.free[row, column]
