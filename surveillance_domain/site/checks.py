"""What the fields of a site file must hold among each other: names, presets, doors, zoom, files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.schema import SiteFile

__all__ = ["check_against_grid", "check_fields"]

_DICTIONARY_SIZE_OF_ARUCO_ORIGINAL = 1024


def check_fields(file: SiteFile, folder: Path) -> tuple[Fault, ...]:
    """Faults among the fields that need no map; ``folder`` is where relative paths start."""
    return tuple(_field_faults(file, folder))


def check_against_grid(file: SiteFile, grid: Grid) -> tuple[Fault, ...]:
    """Faults of places: cameras inside walls, doors that are not free cells."""
    return tuple(_place_faults(file, grid))


def _field_faults(file: SiteFile, folder: Path) -> Iterator[Fault]:
    yield from _repeated("cameras", [camera.name for camera in file.cameras])
    yield from _repeated("static_cameras", [camera.name for camera in file.static_cameras])
    yield from _repeated("targets.known", [target.name for target in file.targets.known])
    markers = [target.marker for target in file.targets.known if target.marker is not None]
    yield from _repeated("targets.known", [str(marker) for marker in markers], "marker")
    for index, camera in enumerate(file.cameras):
        yield from _camera_faults(f"cameras[{index}]", camera, folder)
    speeds = file.targets.speeds_mps
    if any(later <= earlier for earlier, later in pairwise(speeds)):
        yield Fault("targets.speeds_mps", str(list(speeds)), "speeds in rising order, each once")
    for index, area in enumerate(file.privacy):
        x, y = np.array(area.polygon_m).T
        if abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) < 1e-9:
            yield Fault(f"privacy[{index}].polygon_m", "points that enclose no area", "a polygon with an area")
    if file.markers is not None:
        name = file.markers.dictionary
        size = int(name.partition("_")[2]) if name[0].isdigit() else _DICTIONARY_SIZE_OF_ARUCO_ORIGINAL
        for index, target in enumerate(file.targets.known):
            if target.marker is not None and target.marker >= size:
                yield Fault(f"targets.known[{index}].marker", str(target.marker), f"0 to {size - 1}, as {name} has")


def _repeated(where: str, values: Sequence[str], key: str = "name") -> Iterator[Fault]:
    counts = Counter(values)
    for value in (value for value, count in counts.items() if count > 1):
        places = " and ".join(f"{where}[{index}]" for index, other in enumerate(values) if other == value)
        yield Fault(places, f'{key} "{value}" {counts[value]} times', f"each {key} once")


def _camera_faults(where: str, camera: Camera, folder: Path) -> Iterator[Fault]:
    names = [preset.name for preset in camera.presets]
    yield from _repeated(f"{where}.presets", names)
    if camera.home is not None and camera.home not in names:
        yield Fault(f"{where}.home", f'"{camera.home}"', f"one of the presets {', '.join(names)}")
    zooms, angles = zip(*camera.zoom_hfov, strict=True)
    if any(np.diff(zooms) <= 0) or any(np.diff(angles) > 0):
        yield Fault(
            f"{where}.zoom_hfov", str([list(p) for p in camera.zoom_hfov]), "zoom rising, field of view falling"
        )
    for index, preset in enumerate(camera.presets):
        if not min(zooms) <= preset.zoom <= max(zooms):
            limits = f"{min(zooms):g} to {max(zooms):g}, as zoom_hfov covers"
            yield Fault(f"{where}.presets[{index}].zoom", f"{preset.zoom:g}", limits)
        if preset.homography is not None and abs(np.linalg.det(np.array(preset.homography))) < 1e-12:
            yield Fault(f"{where}.presets[{index}].homography", "a singular matrix", "a matrix that can be inverted")
    if camera.required_px_per_m is None and camera.max_depth_m is None:
        yield Fault(where, "no depth", "required_px_per_m or max_depth_m, or both")
    if camera.ca_file is not None:
        if camera.url is None or not camera.url.startswith("https:"):
            yield Fault(f"{where}.ca_file", f'"{camera.ca_file}"', "an https address in url, or no ca_file")
        elif not (folder / camera.ca_file).is_file():
            yield Fault(f"{where}.ca_file", f'"{camera.ca_file}", which is not there', f"a file, relative to {folder}")


def _place_faults(file: SiteFile, grid: Grid) -> Iterator[Fault]:
    for index, camera in enumerate(file.cameras):
        if _inside_blocked_cell(grid, camera.mount.position_m):
            x, y = camera.mount.position_m[:2]
            column, row = grid.cell_at(np.array([x, y])).tolist()
            found = f"[{x:g}, {y:g}], inside the blocked cell [{column}, {row}]"
            yield Fault(
                f"cameras[{index}].mount.position_m", found, "a place in a free cell, on a wall's edge or outside"
            )
    for index, camera_ in enumerate(file.static_cameras):
        if _inside_blocked_cell(grid, camera_.position_m):
            yield Fault(f"static_cameras[{index}].position_m", "a place inside a wall", "a free place or an edge")
    for door_index, door in enumerate(file.targets.doors):
        for cell_index, (column, row) in enumerate(door.cells):
            where = f"targets.doors[{door_index}].cells[{cell_index}]"
            if not (column < grid.columns and row < grid.rows):
                limits = f"column 0 to {grid.columns - 1}, row 0 to {grid.rows - 1}"
                yield Fault(where, f"[{column}, {row}], outside of the map", limits)
            elif not grid.free[row, column]:
                yield Fault(where, f"[{column}, {row}], a blocked cell", "a free cell [column, row]")
    doors = [tuple(cell) for door in file.targets.doors for cell in door.cells]
    yield from _repeated("targets.doors cell", [str(list(cell)) for cell in doors], "cell")


def _inside_blocked_cell(grid: Grid, position_m: Sequence[float]) -> bool:
    """Whether a point lies in the open interior of a blocked cell (on its edge is a wall mounting)."""
    place = (np.array(position_m[:2]) - np.array(grid.origin_m)) / grid.cell_m
    column, row = np.floor(place).astype(int).tolist()
    on_edge = bool(np.any(np.abs(place - np.round(place)) < 1e-4))
    on_map = 0 <= column < grid.columns and 0 <= row < grid.rows
    return on_map and not on_edge and not grid.free[row, column]
