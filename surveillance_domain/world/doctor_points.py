"""Whether a camera still sees the points that it was calibrated from where it saw them then."""

from __future__ import annotations

from collections.abc import Mapping

from surveillance_domain.cameras.base import Picture, Position
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.site import Site
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.calibration_file import Calibrated
from surveillance_domain.vision.drift import Drift, drifted
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.landmarks import found_again
from surveillance_domain.vision.opencv import BadImage, decoded
from surveillance_domain.vision.points import root_mean_square

__all__ = ["points_found"]

_MOST_CELLS_OFF = 0.5
"""A detection farther off than half a cell is told to be in another one."""
_TOLD_DEG = 0.1
_LEAST_POINTS = 2
_AGAIN = "run surveillance calibrate again"


def points_found(
    site: Site, camera: Camera, known: Mapping[str, Calibrated], pictures: Mapping[str, Picture]
) -> tuple[bool, str]:
    """Whether all is well, and what was found and would mend it.

    Parameters
    ----------
    site : Site
    camera : Camera
    known : mapping of str to Calibrated
        By preset.
    pictures : mapping of str to Picture
        Taken now at some of these presets.
    """
    changed = [one.name for one in camera.presets if one.name in known and not _same(one, known[one.name])]
    if changed:
        return False, f"turned elsewhere since they were calibrated: {', '.join(changed)}; {_AGAIN}"
    if not pictures:
        return True, "not looked for: it stands at none of the presets that were calibrated, and is not turned"
    drifts: dict[str, Drift] = {}
    for preset in camera.presets:
        if preset.name in pictures:
            try:
                drifts[preset.name] = _drift(site, camera, preset.name, known[preset.name], pictures[preset.name])
            except BadImage as problem:
                return False, str(problem)
    return _judged(site, drifts, known)


def _same(preset: object, then: Calibrated) -> bool:
    return all(getattr(preset, axis) == getattr(then.preset, axis) for axis in ("pan", "tilt", "zoom"))


def _drift(site: Site, camera: Camera, name: str, known: Calibrated, picture: Picture) -> Drift:
    pixels = decoded(picture.jpeg)
    size = (camera.image.width, camera.image.height)
    if (picture.width, picture.height) != size:
        raise BadImage(f"pictures are {picture.width} x {picture.height}, the points belong to {size[0]} x {size[1]}")
    detections = MarkerDetector(site.markers).detect(pixels) if site.markers is not None else ()
    now = found_again(known.landmarks, pixels, detections)
    (preset,) = [one for one in camera.presets if one.name == name]
    floor = ground(camera, Position(preset.pan, preset.tilt, preset.zoom), size)
    return drifted(camera, preset, floor, [one.point for one in known.landmarks], now)


def _judged(site: Site, drifts: Mapping[str, Drift], known: Mapping[str, Calibrated]) -> tuple[bool, str]:
    found, of = (sum(getattr(one, part) for one in drifts.values()) for part in ("found", "of"))
    looked = f"{found} of {of} points found again at {', '.join(drifts)}"
    seen = {name: one for name, one in drifts.items() if one.found >= _LEAST_POINTS}
    if not seen:
        return True, f"not checked: {looked}; lay the markers out again, or clear the view"
    off_m = root_mean_square([metres for one in seen.values() for metres in one.residuals_m])
    then_m = root_mean_square([known[name].residual_m for name in seen])
    when = min(known[name].when for name in seen)
    told = f"{looked}, {off_m:.3f} m off; {then_m:.3f} m when calibrated ({when})"
    pan, tilt = (sum(getattr(one, axis) for one in seen.values()) / len(seen) for axis in ("pan_deg", "tilt_deg"))
    turned = [f"{value:+.1f}° in {axis}" for axis, value in (("pan", pan), ("tilt", tilt)) if abs(value) >= _TOLD_DEG]
    beside = f"; it looks {' and '.join(turned)} beside what it says" if turned else ""
    if off_m <= _MOST_CELLS_OFF * site.grid.cell_m:
        return True, told + beside
    return False, (
        f"{told}{beside}, more than half a cell: restart it, so that it finds its end stops; if that does not help, "
        f"its mount was moved: {_AGAIN}"
    )
