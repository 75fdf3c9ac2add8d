"""Whether a camera's pictures are large enough, and whether they lie on the floor where they should."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.base import Picture, Position
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.sections import Markers
from surveillance_domain.site.site import Site
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.marker_size import LEAST_SIDE_PX, marker_sides_px
from surveillance_domain.vision.opencv import BadImage, decoded
from surveillance_domain.vision.points import FloorMarker, marked_points, residuals, root_mean_square

__all__ = ["calibration", "markers_known", "markers_readable", "resolution"]

_HERE = "here"
_MOST_CELLS_OFF = 0.5
"""A detection farther off than half a cell is told to be in another one."""

Found = tuple[bool, str]
"""Whether it is well, and what was found."""


def resolution(camera: Camera, picture: Picture) -> Found:
    """Whether pictures have the size that the site reckons with."""
    wanted = (camera.image.width, camera.image.height)
    found = (picture.width, picture.height)
    if found == wanted:
        return True, f"{found[0]} x {found[1]}"
    return False, (
        f"pictures are {found[0]} x {found[1]}, the site says {wanted[0]} x {wanted[1]}: set image to what the camera "
        "gives, for what it can recognise depends on it"
    )


def markers_readable(site: Site, camera: Camera, detection: Float[np.ndarray, "presets cells"]) -> Found:
    """Whether markers are large enough to be read wherever a preset is said to see."""
    markers = site.markers
    if markers is None:
        raise ValueError(f"site {site.name} has no markers")
    far, small = [], []
    for preset, seen in zip(camera.presets, detection, strict=True):
        view = pinhole(camera, preset.pan, preset.tilt, preset.zoom)
        sides = marker_sides_px(view, markers, site.grid.centres_m[seen > 0])
        least = float(np.nanmin(sides))
        far.append(least)
        if least < LEAST_SIDE_PX:
            small.append(f'{least:.0f} px at the far edge of "{preset.name}"')
    if not small:
        return True, f"{min(far):.0f} px a side at the far edge, {LEAST_SIDE_PX:.0f} are needed"
    side_m = markers.side_m * LEAST_SIDE_PX / min(far)
    return False, (
        f"{', '.join(small)}, {LEAST_SIDE_PX:.0f} are needed: zoom in, use markers of {side_m:.2f} m, larger pictures, "
        "or a smaller max_depth_m"
    )


def calibration(site: Site, camera: Camera, detection: Float[np.ndarray, "presets cells"]) -> Found:
    """Whether homographies agree with mount and lens over what each preset sees."""
    worst, where = 0.0, ""
    size = (camera.image.width, camera.image.height)
    for preset, seen in zip(camera.presets, detection, strict=True):
        if preset.homography is None:
            continue
        view = pinhole(camera, preset.pan, preset.tilt, preset.zoom)
        places = site.grid.centres_m[seen > 0]
        pixels = view.project(np.pad(places, ((0, 0), (0, 1))))
        floor = ground(camera, Position(preset.pan, preset.tilt, preset.zoom), size)
        away = np.linalg.norm(floor.on_floor(pixels, np.zeros(len(pixels))) - places, axis=1)
        off = float("inf") if np.isnan(away).any() else float(away.max())
        if off >= worst:
            worst, where = off, preset.name
    limit_m = _MOST_CELLS_OFF * site.grid.cell_m
    told = f'homography and mount differ by up to {worst:.2f} m on the floor (preset "{where}")'
    if worst <= limit_m:
        return True, told
    return False, (
        f"{told}, more than half a cell: has the camera been moved? run surveillance calibrate again; where its "
        "homographies are right, fit its mount too (--mount), for fields of view are worked out from that"
    )


def markers_known(site: Site, camera: Camera, picture: Picture, markers: Mapping[int, FloorMarker]) -> Found:
    """Whether markers that lie at known places are found there."""
    described = site.markers if site.markers is not None else Markers(side_m=1.0)
    try:
        detections = MarkerDetector(described).detect(decoded(picture.jpeg))
    except BadImage as problem:
        return False, str(problem)
    points = marked_points(_HERE, detections, markers)
    if not points:
        return False, "none of the markers is seen from where it looks: lay one into its view, or turn it there"
    floor = ground(camera, picture.position, (picture.width, picture.height))
    off_m = root_mean_square([one.metres for one in residuals(points, {_HERE: floor})])
    limit_m = _MOST_CELLS_OFF * site.grid.cell_m
    told = f"{len(points)} markers seen {off_m:.2f} m from where they lie"
    if off_m <= limit_m:
        return True, told
    return False, f"{told}, more than half a cell: run surveillance calibrate again"
