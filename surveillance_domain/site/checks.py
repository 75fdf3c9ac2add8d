"""What the fields of a site file must hold among each other: names, presets, zoom, depth, files."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.schema import SiteFile

__all__ = ["check_fields"]

_DICTIONARY_SIZE_OF_ARUCO_ORIGINAL = 1024
_WIDEST_MASK_DEG = 180.0


def check_fields(file: SiteFile, folder: Path) -> tuple[Fault, ...]:
    """Faults among the fields that need no map; ``folder`` is where relative paths start."""
    return tuple(_field_faults(file, folder))


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
    """A fault for each value that stands more than once in a list of tables."""
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
    for index, mask in enumerate(camera.privacy_masks):
        (first, last), (low, high) = mask.pan_deg, mask.tilt_deg
        wide = (last - first) % 360
        if not 0 < wide <= _WIDEST_MASK_DEG or abs(last - first) >= 360:
            expected = (
                f"pan rising from the first to the second by more than 0 and at most {_WIDEST_MASK_DEG:g} degrees "
                "([170, -170] goes over 180); two masks for more"
            )
            yield Fault(f"{where}.privacy_masks[{index}].pan_deg", f"[{first:g}, {last:g}]", expected)
        if not 0 < high - low <= _WIDEST_MASK_DEG:
            expected = f"the lower one first, at most {_WIDEST_MASK_DEG:g} degrees apart"
            yield Fault(f"{where}.privacy_masks[{index}].tilt_deg", f"[{low:g}, {high:g}]", expected)
    if camera.required_px_per_m is None and camera.max_depth_m is None:
        yield Fault(where, "no depth", "required_px_per_m or max_depth_m, or both")
    if camera.ca_file is not None:
        if camera.url is None or not camera.url.startswith("https:"):
            yield Fault(f"{where}.ca_file", f'"{camera.ca_file}"', "an https address in url, or no ca_file")
        elif not (folder / camera.ca_file).is_file():
            yield Fault(f"{where}.ca_file", f'"{camera.ca_file}", which is not there', f"a file, relative to {folder}")
