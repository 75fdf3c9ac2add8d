"""``surveillance calibrate``: where a camera's pictures lie on the floor, from known points in them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, AsJson, InputError, answer
from surveillance_domain.commands.options import SiteName, input_checked

if TYPE_CHECKING:
    from collections.abc import Sequence

    from surveillance_domain.commands.calibration_answer import Fitted
    from surveillance_domain.site.camera import Camera
    from surveillance_domain.vision.points import FloorPoint

__all__ = ["calibrate"]

_MOST_CELLS_OFF = 0.5
"""A calibration whose residual is larger is not written."""


def calibrate(
    site: SiteName,
    camera: Annotated[str, typer.Argument(metavar="CAMERA", help="One of the site's cameras.")],
    points: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV or JSON: preset, u, v (pixels), x_m, y_m; height_m, name if you like."),
    ] = None,
    floor_markers: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="CSV or JSON: marker, x_m, y_m; height_m. Looked for in the pictures."),
    ] = None,
    picture: Annotated[
        list[str] | None, typer.Option(metavar="PRESET=FILE", help="A picture taken at a preset; may be repeated.")
    ] = None,
    live: Annotated[
        bool, typer.Option("--live", help="Turn the camera to each other preset and take its picture; then back.")
    ] = False,
    mount: Annotated[
        bool, typer.Option("--mount", help="Fit the camera's mount, for all presets, not a homography for each.")
    ] = False,
    focal: Annotated[bool, typer.Option("--focal/--no-focal", help="With --mount: fit the focal length too.")] = True,
    position: Annotated[bool, typer.Option("--position", help="With --mount: fit where it hangs, too.")] = False,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for pictures with the floor's grid drawn over them.")
    ] = None,
    write: Annotated[
        bool, typer.Option("--write", help="Put the result into the site file, its points beside it for the doctor.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Solve a camera's calibration and say how well it fits: by a homography for each preset, or by its mount."""
    from factored_pomdp.provenance import provenance
    from surveillance_domain.commands import calibration_answer, calibration_input
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.commands.one_camera import described_camera
    from surveillance_domain.site.editing import editable_path
    from surveillance_domain.site.load import load_site
    from surveillance_domain.vision.opencv import VisionMissing, opencv

    with input_checked((ValueError, VisionMissing)):
        opencv()
        found = load_site(site)
        path = editable_path(found) if write else None
    description = described_camera(found, camera)
    if out is not None:
        ready_folder(out)
    taken = calibration_input.pictures(found, description, picture or [], live)
    with input_checked():
        known = calibration_input.known_points(found, description, points, floor_markers, taken)
    looked_for = () if floor_markers is None else tuple(taken)
    fitted, refused = _fitted(description, known, looked_for, mount, focal, position)
    drawn = [] if out is None else calibration_answer.draw(found, description, fitted, taken, out)
    kept = _kept(fitted, _MOST_CELLS_OFF * found.grid.cell_m)
    if path is not None and kept:
        with input_checked((ValueError, OSError)):
            calibration_answer.write(found, path, description, kept)
            calibration_answer.keep_points(path, description, kept, taken)
    carried = provenance(COMMAND_LINE.get(), {found.name: f"sha256:{found.digest}"})
    content: dict[str, Any] = {
        "site": found.name,
        "camera": camera,
        **calibration_answer.content(fitted, kept),
        "refused": [{"preset": preset, "because": because} for preset, because in refused.items()],
        "fits": kept is fitted and not refused,
        "written": str(path) if path is not None and kept else None,
        "pictures": [str(one) for one in drawn],
        **carried,
    }
    answer(content, calibration_answer.shown(content), as_json=as_json)
    if not content["fits"]:
        raise typer.Exit(1)


def _fitted(
    camera: Camera, points: tuple[FloorPoint, ...], looked_for: Sequence[str], mount: bool, focal: bool, position: bool
) -> tuple[Fitted, dict[str, str]]:
    """What was asked for; of homographies those that there are, and for the other presets why not.

    Raises
    ------
    InputError
        If there is none at all.
    """
    from surveillance_domain.vision.homography import CalibrationError, HomographyFit, fit_homography
    from surveillance_domain.vision.mount_fit import fit_mount

    if mount:
        with input_checked():
            return fit_mount(camera, points, focal, position), {}
    pointed = {point.preset for point in points}.union(looked_for)
    fits: list[HomographyFit] = []
    refused: dict[str, str] = {}
    for preset in (one.name for one in camera.presets if one.name in pointed):
        try:
            fits.append(fit_homography(camera, preset, points))
        except CalibrationError as problem:
            refused[preset] = str(problem)
    if not fits:
        raise InputError("\n".join(refused.values()))
    return tuple(fits), refused


def _kept(fitted: Fitted, most_m: float) -> Fitted | None:
    """What fits well enough to be written; ``None``: nothing."""
    if not isinstance(fitted, tuple):
        return fitted if fitted.residual_m <= most_m else None
    good = tuple(one for one in fitted if one.residual_m <= most_m)
    return good if len(good) < len(fitted) else fitted
