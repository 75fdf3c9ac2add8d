"""What ``surveillance calibrate`` is given: pictures from files or the camera, points from files or markers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import InputError, side_console
from surveillance_domain.commands.options import input_checked

if TYPE_CHECKING:
    from surveillance_domain.cameras.base import Camera as CameraDriver
    from surveillance_domain.site.camera import Camera
    from surveillance_domain.site.site import Site
    from surveillance_domain.vision.points import FloorPoint

__all__ = ["known_points", "pictures"]

_BUDGET_S = 10.0
_SAME_SHAPE = 0.01


def pictures(site: Site, camera: Camera, given: Sequence[str], live: bool) -> dict[str, Any]:
    """For each preset that has one its picture, blue, green and red, in the size that the site gives.

    Raises
    ------
    InputError
        For a preset that is not there, a file that is no picture or has another shape, a camera that does not answer.
    """
    from factored_pomdp.errors import did_you_mean
    from surveillance_domain.vision.opencv import BadImage, read_image

    names = [preset.name for preset in camera.presets]
    found: dict[str, Any] = {}
    for one in given:
        preset, equals, file = one.partition("=")
        if not equals or not file:
            raise InputError(f"--picture {one}: expected PRESET=FILE, such as {names[0]}={names[0]}.jpg")
        if preset not in names:
            raise InputError(
                f"--picture {one}: camera {camera.name!r} has no preset {preset!r}{did_you_mean(preset, names)}"
            )
        if preset in found:
            raise InputError(f"--picture: {preset} stands there twice")
        with input_checked((BadImage,)):
            found[preset] = _in_size(camera, f"--picture {one}", read_image(Path(file)))
    if live:
        found |= _taken(site, camera, [name for name in names if name not in found])
    return found


def known_points(
    site: Site,
    camera: Camera,
    points: Path | None,
    floor_markers: Path | None,
    taken: Mapping[str, Any],
) -> tuple[FloorPoint, ...]:
    """All points of the files, and those markers of known places that the pictures show.

    Raises
    ------
    InputError
        If nothing was given, or no marker was seen.
    SiteError
        With every fault of a file.
    """
    from surveillance_domain.vision.aruco import MarkerDetector
    from surveillance_domain.vision.point_files import read_markers, read_points
    from surveillance_domain.vision.points import marked_points

    if points is None and floor_markers is None:
        raise InputError(
            "nothing to calibrate from: give --points FILE, or --floor-markers FILE and --picture PRESET=FILE or --live"
        )
    known = [] if points is None else list(read_points(points, camera))
    if floor_markers is not None:
        if site.markers is None:
            raise InputError(f"--floor-markers: site {site.name} has no [markers] table that names their dictionary")
        if not taken:
            raise InputError("--floor-markers: no pictures to look for them in; give --picture PRESET=FILE, or --live")
        markers, detector = read_markers(floor_markers), MarkerDetector(site.markers)
        for preset, pixels in taken.items():
            seen = marked_points(preset, detector.detect(pixels), markers)
            side_console().print(f"{preset}: {len(seen)} of {len(markers)} known markers seen")
            known += seen
    if not known:
        raise InputError("none of the known markers is in the pictures; see docs of [markers]: dictionary and size")
    return tuple(known)


def _taken(site: Site, camera: Camera, presets: Sequence[str]) -> dict[str, Any]:
    """Turn to presets, one after the other, and back to where the camera looked before."""
    from surveillance_domain.cameras.base import Position
    from surveillance_domain.commands.one_camera import opened_camera
    from surveillance_domain.commands.watch_state import state_of
    from surveillance_domain.control.watch_state import AlreadyRun
    from surveillance_domain.vision.opencv import BadImage
    from surveillance_domain.world.memory import Memory, still_for_s
    from surveillance_domain.world.yielding import MOVED

    state = state_of(site)
    if camera.name in state.held():
        raise InputError(f"camera {camera.name!r} is held by somebody; it is not moved")
    found = {}
    with input_checked((AlreadyRun, BadImage)), state.locked(), opened_camera(site, camera) as driver:
        before, yield_s = driver.position(_BUDGET_S), site.operation.yield_s
        memory = state.memories().get(camera.name, Memory())
        still_s = still_for_s(memory, yield_s, camera.tolerance_deg, before)
        if still_s is not None:
            raise InputError(
                f"camera {camera.name!r}: {MOVED} {still_s:.0f} s ago; it is not turned before it has been still for "
                f"{yield_s:g} s"
            )
        try:
            for preset in camera.presets:
                if preset.name in presets:
                    there = Position(preset.pan, preset.tilt, preset.zoom)
                    found[preset.name] = _in_size(
                        camera, preset.name, _picture_at(driver, there, camera.move_deadline_s)
                    )
        finally:
            driver.move(before, camera.move_deadline_s)
    return found


def _picture_at(driver: CameraDriver, there: Any, deadline_s: float) -> Any:
    from surveillance_domain.cameras.base import Outcome
    from surveillance_domain.vision.opencv import decoded

    move = driver.move(there, deadline_s)
    if move.outcome is not Outcome.REACHED:
        raise InputError(f"camera {driver.name!r}: {move.outcome} on the way to a preset; {move.because}")
    return decoded(driver.picture(_BUDGET_S).jpeg)


def _in_size(camera: Camera, where: str, pixels: Any) -> Any:
    """In the site's size; the shape must be the site's, for calibration holds for pictures of that shape."""
    from surveillance_domain.vision.opencv import opencv

    height, width = pixels.shape[:2]
    size = (camera.image.width, camera.image.height)
    if abs(width / height / (size[0] / size[1]) - 1) > _SAME_SHAPE:
        raise InputError(
            f"{where}: {width} x {height} pixels; the site says {size[0]} x {size[1]} (image), another shape"
        )
    return pixels if (width, height) == size else opencv().resize(pixels, size)
