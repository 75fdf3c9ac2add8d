"""What ``surveillance learn --write`` does to a site file: checked before long work begins, all or nothing after it."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import InputError, side_console
from surveillance_domain.commands.options import input_checked

if TYPE_CHECKING:
    from surveillance_domain.site.site import Site
    from surveillance_domain.trajectories.fitting import MotionFit
    from surveillance_domain.trajectories.prior import PlacedPrior

__all__ = ["checked_site", "of_turning", "of_walls", "prior_path", "write_learned"]

_TURNS_ENOUGH = 0.8
"""Of the sigma that was learned: where the grid's turns have less, more directions are advised."""
_DIRECTIONS = (8, 12, 16, 24, 36, 48, 72)
_COMMENT = re.compile(r"#[^\n]*")


def checked_site(path: Path, step_s: float, cell_m: float, with_prior: bool) -> Site:
    """The site to be changed.

    Raises
    ------
    InputError
        If it is no sound site file, may not be changed, or has another step.
    """
    from surveillance_domain.site.editing import editable_path
    from surveillance_domain.site.load import load_site

    if not path.is_file():
        raise InputError(f"--write {path}: no such file; expected a site file that is there already")
    with input_checked():
        site = load_site(path)
    path = editable_path(site)
    _check_writable(path)
    if with_prior:
        other = prior_path(path)
        if other.exists() and site.targets.prior != other.name:
            raise InputError(
                f"--write {path}: the prior would be written to {other}, which is there already and not of this site; "
                "expected no file of that name: move it away"
            )
        if other.exists():
            _check_writable(other)
    if abs(site.control.step_s - step_s) > 1e-9:
        raise InputError(
            f"--write {path}: its control.step_s is {site.control.step_s:g}, and sigmas hold for one step of "
            f"--step-s {step_s:g}; learn with --step-s {site.control.step_s:g}"
        )
    if abs(site.grid.cell_m - cell_m) > 1e-9:
        told = f"{path}: its cells are {site.grid.cell_m:g} m; the likelihoods on the grid are for {cell_m:g} m"
        side_console().print(told, style="yellow", soft_wrap=True)
    return site


def _check_writable(path: Path) -> None:
    """Refuse a file that is meant to be read only (for whoever may write all the same, too), and a closed folder."""
    if not (path.stat().st_mode & 0o222 and os.access(path, os.W_OK)):
        raise InputError(f"--write {path}: a read-only file, which is left as it is; expected one that may be written")
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as problem:
        raise InputError(
            f"--write {path}: cannot write in the folder {path.parent.absolute()}: "
            f"{(problem.strerror or str(problem)).lower()}; a changed file is written beside the old one and put in "
            "its place: expected a folder in which you may write, or a copy of the site file in one"
        ) from None


def of_walls(site: Site, fit: MotionFit) -> str | None:
    """What is to be told where people who move as was learned would gather along the walls of this site."""
    from dataclasses import replace

    from surveillance_domain.model.build import motion_parameters
    from surveillance_domain.trajectories.long_run import STEPS, drawn_to_walls

    parameters = replace(
        motion_parameters(site),
        speeds_mps=fit.speeds_mps,
        sigma_direction_deg=fit.sigma_direction_deg,
        sigma_speed_mps=fit.sigma_speed_mps,
    )
    cells = drawn_to_walls(site.grid, parameters)
    if cells is None:
        return None
    return (
        f'{site.path}: with walls = "{parameters.walls}" people who turn by {fit.sigma_direction_deg:.3g}° a step '
        f"follow a wall once they have met it: {STEPS} steps on, half of them would be in {cells[0]:,} of "
        f'{site.grid.size:,} cells, with walls = "reflect" in {cells[1]:,}; set that in [targets], or simulated people '
        "gather in corners"
    )


def of_turning(directions: int, fit: MotionFit, where: str) -> str | None:
    """What is to be told where a number of directions is too small for people who turn as was learned."""
    from surveillance_domain.model.motion_direction import turning_deg

    sigma = fit.sigma_direction_deg
    found = turning_deg(directions, sigma)
    if found >= _TURNS_ENOUGH * sigma:
        return None
    enough = next((n for n in _DIRECTIONS if 360 / n <= 2 * sigma), _DIRECTIONS[-1])
    return (
        f"with {directions} directions a target turns by {found:.2g}° a step in place of {sigma:.3g}°, and goes "
        f"straight on where people bend: {where.format(enough)} has bins no wider than two sigmas"
    )


def prior_path(site: Path) -> Path:
    """Where the prior of a site file is written: ``hall.toml`` has ``hall-prior.csv`` beside it.

    A file that a symbolic link points to has it beside itself, not beside the link.
    """
    return site.with_name(f"{site.stem}-prior.csv")


def write_learned(site: Site, fit: MotionFit, prior: PlacedPrior | None) -> list[str]:
    """Set the learned keys of ``[targets]``, leave everything else in the file as it is; returns the files written.

    Raises
    ------
    InputError
        If it cannot be done; then all files are as they were.
    """
    import tomlkit

    from surveillance_domain.site.editing import editable_path, edited_site
    from surveillance_domain.site.prior import prior_text

    path = editable_path(site)
    beside = prior_path(path)
    before = beside.read_bytes() if beside.is_file() else None
    try:
        with input_checked((ValueError, OSError)):
            if prior is not None:
                _put(beside, prior_text(prior.probability, site.grid).encode())
            with edited_site(path) as document:
                targets: Any = document.setdefault("targets", tomlkit.table())
                lost = _set_speeds(targets, [round(speed, 3) for speed in fit.speeds_mps])
                targets["sigma_direction_deg"] = round(fit.sigma_direction_deg, 3)
                targets["sigma_speed_mps"] = round(fit.sigma_speed_mps, 4)
                if prior is not None:
                    targets["prior"] = beside.name
    except BaseException:
        if prior is not None:
            _put(beside, before)
        raise
    if lost:
        told = f"{path}: comments of speeds that are no more went with them: {'; '.join(lost)}"
        side_console().print(told, style="yellow", soft_wrap=True)
    return [str(path)] if prior is None else [str(path), str(beside)]


def _put(path: Path, content: bytes | None) -> None:
    """The file with this content, whole, or no file."""
    if content is None:
        path.unlink(missing_ok=True)
        return
    unfinished = path.with_name(f".{path.name}.unfinished")
    try:
        unfinished.write_bytes(content)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def _set_speeds(targets: Any, speeds: Sequence[float]) -> list[str]:
    """Change the array in its place, so that its layout and comments stay; returns comments that were lost."""
    array = targets.get("speeds_mps")
    if array is None:
        targets["speeds_mps"] = list(speeds)
        return []
    before = _COMMENT.findall(array.as_string())
    for number, speed in enumerate(speeds[: len(array)]):
        array[number] = speed
    for speed in speeds[len(array) :]:
        array.append(speed)
    while len(array) > len(speeds):
        del array[-1]
    after = _COMMENT.findall(array.as_string())
    return [comment for comment in before if comment not in after]
