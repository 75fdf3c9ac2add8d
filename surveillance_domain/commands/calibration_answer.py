"""What ``surveillance calibrate`` answers, draws and writes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import table
from surveillance_domain.commands.folder import finite

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.site.camera import Camera
    from surveillance_domain.site.site import Site
    from surveillance_domain.vision.ground import Ground
    from surveillance_domain.vision.homography import HomographyFit
    from surveillance_domain.vision.mount_fit import MountFit
    from surveillance_domain.vision.points import PointResidual

    Fitted = MountFit | tuple[HomographyFit, ...]
    """The mount, or the homographies of some presets."""

__all__ = ["content", "draw", "keep_points", "shown", "write"]

_DIGITS = 12
_BACKGROUND = 110
_TOO_FAR = "more than half a cell, which is not written"


def content(fitted: Fitted, kept: Fitted | None) -> dict[str, Any]:
    """The result in types that JSON has; ``kept`` is that of it which fits well enough."""
    if isinstance(fitted, tuple):
        good = {one.preset for one in kept} if isinstance(kept, tuple) else set()
        presets = [
            {
                "name": one.preset,
                **_residual(one),
                "checked": one.checked,
                "fits": one.preset in good,
                "homography": _rows(one),
            }
            for one in fitted
        ]
        return {"method": "homography", "presets": presets, "points": [_point(p) for one in fitted for p in one.points]}
    from surveillance_domain.vision.points import root_mean_square

    return {
        "method": "mount",
        "mount": fitted.camera.mount.model_dump(),
        "zoom_hfov": [list(pair) for pair in fitted.camera.zoom_hfov],
        "focal_scale": fitted.focal_scale,
        **_residual(fitted),
        "residual_px_before": finite(root_mean_square([one.pixels for one in fitted.before])),
        "points": [_point(one) for one in fitted.points],
    }


def shown(answered: Mapping[str, Any]) -> list[RenderableType]:
    """The result for people."""
    numbers = ["pixels off", "metres off"]
    points = table("point", "preset", *numbers, "", right=numbers)
    for one in answered["points"]:
        off = [_number(one["residual_px"], ".1f"), _number(one["residual_m"], ".3f")]
        points.add_row(one["name"], one["preset"], *off, "" if one["fits"] else "does not fit")
    lines: list[RenderableType] = [points]
    for one in answered.get("presets", ()):
        note = "" if one["checked"] else "; four points determine it, more would check it"
        note += "" if one["fits"] else f"; {_TOO_FAR}: measure its points again"
        lines.append(f"Preset {one['name']}: {_off(one)} over {one['fitting']} of {one['points']} points{note}.")
    if "mount" in answered:
        mount, before = answered["mount"], answered["residual_px_before"]
        angles = ", ".join(f"{key} {mount[f'{key}_deg']:.2f}°" for key in ("yaw", "pitch", "roll"))
        place = ", ".join(f"{part:.3f}" for part in mount["position_m"])
        lines.append(f"Mount: {angles}, at [{place}] m; focal length × {answered['focal_scale']:.4f}.")
        was = "outside of the picture" if before is None else f"{before:.1f} pixels"
        lines.append(f"{_off(answered)} over the points that fit; all points before: {was}.")
        if not answered["fits"]:
            lines.append(f"That is {_TOO_FAR}.")
    lines += [f"Not calibrated: {one['because']}." for one in answered["refused"]]
    if answered["written"]:
        which = ", ".join(one["name"] for one in answered.get("presets", ()) if one["fits"])
        some = "" if answered["fits"] else f", of the presets that fit: {which}"
        lines.append(f"Written: {answered['written']}{some}")
    elif not answered["fits"]:
        lines.append("Nothing was written.")
    lines += [f"Look at {picture}" for picture in answered["pictures"]]
    return lines


def draw(
    site: Site,
    camera: Camera,
    fitted: Fitted,
    taken: Mapping[str, Any],
    folder: Path,
) -> list[Path]:
    """The grid over each picture, and over an empty one where points were clicked in a preset without picture."""
    import numpy as np

    from surveillance_domain.vision.opencv import write_png
    from surveillance_domain.vision.overlay import draw_grid

    points = [one for fit in fitted for one in fit.points] if isinstance(fitted, tuple) else list(fitted.points)
    drawn = []
    for preset, floor in _grounds(camera, fitted).items():
        mine = [one for one in points if one.point.preset == preset]
        if preset not in taken and not mine:
            continue
        empty = np.full((camera.image.height, camera.image.width, 3), _BACKGROUND, dtype=np.uint8)
        path = folder / f"{_file_name(camera.name)}-{_file_name(preset)}.png"
        write_png(path, draw_grid(taken.get(preset, empty), floor, site.grid, mine))
        drawn.append(path)
    return drawn


def write(site: Site, path: Path, camera: Camera, fitted: Fitted) -> None:
    """Put the result into the site file; a new mount makes the camera's homographies void.

    Raises
    ------
    SiteError
        If the site would not be sound any more, a preset that sees nothing by the new mount being named.
    OSError
        If the file cannot be written.
    """
    from surveillance_domain.site.editing import edited_site, set_camera_key, set_homography

    with edited_site(path, _views_check(site)) as document:
        if isinstance(fitted, tuple):
            for one in fitted:
                set_homography(document, camera.name, one.preset, _rows(one))
            return
        old, new = camera.mount.model_dump(), fitted.camera.mount.model_dump()
        set_camera_key(document, camera.name, "mount", {key: _plain(new[key]) for key in new if new[key] != old[key]})
        if fitted.camera.zoom_hfov != camera.zoom_hfov:
            set_camera_key(document, camera.name, "zoom_hfov", [list(pair) for pair in fitted.camera.zoom_hfov])
        for preset in camera.presets:
            if preset.homography is not None:
                set_homography(document, camera.name, preset.name, None)


def _views_check(site: Site) -> Callable[[Site], object] | None:
    """Fields of view must be as sound as before; a site that has blind presets already may be mended bit by bit."""
    from surveillance_domain.model.views import build_views
    from surveillance_domain.site.faults import SiteError

    try:
        build_views(site)
    except SiteError:
        return None
    return build_views


def keep_points(path: Path, camera: Camera, fitted: Fitted, taken: Mapping[str, Any]) -> None:
    """Write the points that fit beside the site file, for the doctor to look for them again.

    Raises
    ------
    SiteError
        If the file that is there is none of ours.
    OSError
        If it cannot be written.
    """
    from datetime import UTC, datetime
    from math import isfinite

    from surveillance_domain.vision.calibration_file import Calibrated, calibration_path, write_calibrations
    from surveillance_domain.vision.landmarks import landmarks
    from surveillance_domain.vision.points import root_mean_square

    when = datetime.now(UTC).isoformat(timespec="seconds")
    points = [one for fit in fitted for one in fit.points] if isinstance(fitted, tuple) else list(fitted.points)
    made = []
    for preset in camera.presets:
        mine = [one for one in points if one.fits and one.point.preset == preset.name and isfinite(one.metres)]
        if mine:
            known = landmarks([one.point for one in mine], taken)
            made.append(Calibrated(preset, when, root_mean_square([one.metres for one in mine]), known))
    write_calibrations(calibration_path(path), camera.name, made, anew=not isinstance(fitted, tuple))


def _grounds(camera: Camera, fitted: Fitted) -> dict[str, Ground]:
    if isinstance(fitted, tuple):
        return {one.preset: one.ground for one in fitted}
    from surveillance_domain.cameras.base import Position
    from surveillance_domain.vision.ground import ground

    size = (camera.image.width, camera.image.height)
    return {
        one.name: ground(fitted.camera, Position(one.pan, one.tilt, one.zoom), size) for one in fitted.camera.presets
    }


def _residual(fit: MountFit | HomographyFit) -> dict[str, Any]:
    return {
        "points": len(fit.points),
        "fitting": sum(one.fits for one in fit.points),
        "residual_px": finite(fit.residual_px),
        "residual_m": finite(fit.residual_m),
    }


def _point(one: PointResidual) -> dict[str, Any]:
    off = {"residual_px": finite(one.pixels), "residual_m": finite(one.metres)}
    return {"name": one.point.name, "preset": one.point.preset, **off, "fits": one.fits}


def _rows(fit: HomographyFit) -> list[list[float]]:
    return [[float(f"{part:.{_DIGITS}g}") for part in row] for row in fit.ground.to_floor.tolist()]


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, Sequence) else value


def _off(one: Mapping[str, Any]) -> str:
    return f"{_number(one['residual_px'], '.2f')} pixels, {_number(one['residual_m'], '.4f')} m off"


def _number(value: float | None, form: str) -> str:
    return "not seen" if value is None else format(value, form)


def _file_name(name: str) -> str:
    return "".join(letter if letter.isalnum() or letter in "-_" else "_" for letter in name)
