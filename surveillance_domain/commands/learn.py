"""``surveillance learn``: the motion model's numbers, learned from recorded people."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import (
    COMMAND_LINE,
    AsJson,
    InputError,
    answer,
    checked_output,
    side_console,
    table,
)
from surveillance_domain.commands.options import Seed, input_checked
from surveillance_domain.commands.recordings import (
    Columns,
    FastestMps,
    FramesPerS,
    HomographyFile,
    MaxGap,
    MetresPerUnit,
    conventions,
    count_lines,
    digest_of,
    read_tracks,
)

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.trajectories.fitting import MotionFit
    from surveillance_domain.trajectories.held_out import HeldOut
    from surveillance_domain.trajectories.prior import CellPrior
    from surveillance_domain.trajectories.tracks import Track, Tracks

__all__ = ["learn"]

_OFTEN_IMPOSSIBLE = 0.05


def learn(
    trajectories: Annotated[list[Path], typer.Argument(metavar="TRAJECTORIES…", help="Files of recorded people.")],
    step_s: Annotated[float, typer.Option(help="Step of the model in seconds; the sigmas hold for it.")],
    cell_m: Annotated[float, typer.Option(help="Side of a planning cell in metres.")],
    frames_per_s: FramesPerS = None,
    metres_per_unit: MetresPerUnit = None,
    homography: HomographyFile = None,
    columns: Columns = None,
    speeds: Annotated[int, typer.Option(min=1, max=20, help="How many speeds the set is to hold.")] = 3,
    directions: Annotated[int, typer.Option(min=1, max=360, help="Of the model on the grid that is judged.")] = 8,
    held_out: Annotated[float, typer.Option(min=0.05, max=0.95, help="Share of the people held out.")] = 0.3,
    max_gap_s: MaxGap = 2.0,
    fastest_mps: FastestMps = 10.0,
    seed: Seed = 0,
    write: Annotated[
        Path | None, typer.Option(metavar="SITE.toml", help="A site file whose sigmas and speeds are set to these.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="PNG", help="Predicted beside real displacements; an SVG beside it.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Learn how people move: sigmas of direction and speed, a set of speeds, a prior, and how well they foretell."""
    import numpy as np

    from surveillance_domain.trajectories.fitting import fit_motion
    from surveillance_domain.trajectories.held_out import held_out_log_likelihood
    from surveillance_domain.trajectories.prior import cell_prior
    from surveillance_domain.trajectories.transitions import split_people, transitions

    for name, value in (("--step-s", step_s), ("--cell-m", cell_m)):
        if not 0 < value < float("inf"):
            raise InputError(f"{name} {value:g}: expected a number above 0")
    if picture is not None and (picture.suffix.lower() not in (".png", ".svg") or picture.is_dir()):
        raise InputError(f"--picture {picture}: expected the name of a file that ends in .png")
    if write is not None:
        _check_site(write, step_s, cell_m)
    given = conventions(frames_per_s, metres_per_unit, homography, columns)
    found = {path: read_tracks(path, given, max_gap_s, fastest_mps) for path in dict.fromkeys(trajectories)}
    tracks = _together(found, step_s)
    if picture is not None:
        checked_output("--picture", picture)
    rng = np.random.default_rng(seed)
    with input_checked():
        everyone = transitions(tracks, step_s)
        fit = fit_motion(everyone, speeds)
        training, rest = split_people(tracks, held_out, rng)
        judged_fit, judging = fit_motion(transitions(training, step_s), speeds), transitions(rest, step_s)
        judged = held_out_log_likelihood(judged_fit, judging, cell_m, directions)
        prior = cell_prior(everyone.points_m, cell_m) if len(found) == 1 else None
    content = _content(found, tracks, fit, judged, prior, directions, seed) | {
        "steps": len(everyone.moves_mps),
        "turns": len(everyone.turns_rad),
    }
    written = []
    if picture is not None:
        written += _draw(judged_fit, judging, picture, [path.name for path in found], rng)
    if write is not None:
        written.append(str(_write(write, fit)))
    content["written"] = written
    if judged.impossible > _OFTEN_IMPOSSIBLE:
        side_console().print(
            f"{judged.impossible:.0%} of the held-out steps end, in part, in cells that {directions} directions and "
            f"{len(fit.speeds_mps)} speeds on cells of {cell_m:g} m cannot reach: "
            "take more directions, larger cells or shorter steps",
            style="yellow",
            soft_wrap=True,
        )
    answer(content, _shown(content, written), as_json=as_json)


def _check_site(path: Path, step_s: float, cell_m: float) -> None:
    """Refuse to write sigmas of one step into a site of another, before long work begins."""
    from surveillance_domain.site.load import load_site

    if not path.is_file():
        raise InputError(f"--write {path}: no such file; expected a site file that is there already")
    with input_checked():
        site = load_site(path)
    if abs(site.control.step_s - step_s) > 1e-9:
        raise InputError(
            f"--write {path}: its control.step_s is {site.control.step_s:g}, and sigmas hold for one step of "
            f"--step-s {step_s:g}; learn with --step-s {site.control.step_s:g}"
        )
    if abs(site.grid.cell_m - cell_m) > 1e-9:
        told = f"{path}: its cells are {site.grid.cell_m:g} m; the likelihoods on the grid are for {cell_m:g} m"
        side_console().print(told, style="yellow", soft_wrap=True)


def _together(found: Mapping[Path, Tracks], step_s: float) -> list[Track]:
    """The tracks of all files; people of different files are different people.

    Raises
    ------
    InputError
        If the step is finer than a recording: what lies between its points is interpolated, and never turns.
    """
    from dataclasses import replace

    tracks: list[Track] = []
    for number, (path, one) in enumerate(found.items()):
        if step_s < one.frame_s * (1 - 1e-6):
            raise InputError(f"{path}: recorded every {one.frame_s:.3g} s; expected a --step-s no shorter than that")
        tracks += [replace(track, name=f"{number}:{track.name}") for track in one.tracks]
    if len({track.name for track in tracks}) < 2:
        raise InputError(f"{', '.join(map(str, found))}: one person alone; expected two or more, one to be held out")
    return tracks


def _content(
    found: Mapping[Path, Tracks],
    tracks: Sequence[Track],
    fit: MotionFit,
    judged: HeldOut,
    prior: CellPrior | None,
    directions: int,
    seed: int,
) -> dict[str, Any]:
    from functools import reduce
    from operator import add

    from factored_pomdp.provenance import provenance
    from surveillance_domain.commands.folder import finite

    carried = provenance(COMMAND_LINE.get(), {str(path): digest_of(path) for path in found}, seed)
    return {
        "sigma_direction_deg": fit.sigma_direction_deg,
        "sigma_speed_mps": fit.sigma_speed_mps,
        "mean_speed_mps": fit.mean_speed_mps,
        "speeds": list(fit.speeds_mps),
        "trajectories": len({track.name for track in tracks}),
        "step_s": fit.step_s,
        "held_out_log_likelihood": judged.model,
        "held_out": {
            "unit": "nats a step, of the cell of the next position",
            "model": judged.model,
            "on_grid": judged.on_grid,
            "random_walk": judged.random_walk,
            "constant_velocity": judged.constant_velocity,
            "model_over_random_walk_ci95": [finite(end) for end in judged.over_random_walk],
            "model_over_constant_velocity_ci95": [finite(end) for end in judged.over_constant_velocity],
            "steps": judged.steps,
            "trajectories": judged.people,
            "directions": directions,
            "impossible_on_grid": judged.impossible,
        },
        "prior": None
        if prior is None
        else {"origin_m": prior.origin_m, "cell_m": prior.cell_m, "rows_from_below": prior.probability.tolist()},
        "counts": reduce(add, (one.counts for one in found.values())).as_dict(),
        "recorded_every_s": {str(path): one.frame_s for path, one in found.items()},
        "warnings": [f"{path}: {warning}" for path, one in found.items() for warning in one.warnings],
        **carried,
        "provenance": carried,
    }


def _draw(fit: MotionFit, judging: Any, picture: Path, names: Sequence[str], rng: Any) -> list[str]:
    import numpy as np

    from surveillance_domain.pictures.motion_fit import FittedMotion, draw_motion_fit
    from surveillance_domain.pictures.style import save_figure
    from surveillance_domain.trajectories.transitions import STILL_MPS

    fitted = FittedMotion(
        before_m=judging.before_m,
        after_m=judging.after_m,
        turns_deg=np.degrees(judging.turns_rad),
        speeds_mps=judging.moves_mps,
        sigma_direction_deg=fit.sigma_direction_deg,
        sigma_speed_mps=fit.sigma_speed_mps,
        speed_set_mps=fit.speeds_mps,
        step_s=fit.step_s,
        still_mps=STILL_MPS,
    )
    figure = draw_motion_fit(fitted, f"Learned from {', '.join(names)}, judged by people held out", rng)
    return [str(path) for path in save_figure(figure, picture)]


def _write(path: Path, fit: MotionFit) -> Path:
    """Set the learned keys of ``[targets]`` and leave everything else in the file as it is."""
    import tomlkit

    from surveillance_domain.site.editing import edited_site

    with input_checked((ValueError, OSError)), edited_site(path) as document:
        targets: Any = document.setdefault("targets", tomlkit.table())
        targets["speeds_mps"] = [round(speed, 3) for speed in fit.speeds_mps]
        targets["sigma_direction_deg"] = round(fit.sigma_direction_deg, 3)
        targets["sigma_speed_mps"] = round(fit.sigma_speed_mps, 4)
    return path


def _shown(content: Mapping[str, Any], written: Sequence[str]) -> list[RenderableType]:
    rows = table("learned", "found", right=["found"])
    rows.add_row("sigma of the direction, a step", f"{content['sigma_direction_deg']:.2f}°")
    rows.add_row("sigma of the speed, a step", f"{content['sigma_speed_mps']:.3f} m/s")
    rows.add_row("speeds", ", ".join(f"{speed:g}" for speed in content["speeds"]) + " m/s")
    rows.add_row("mean speed", f"{content['mean_speed_mps']:.3f} m/s")
    rows.add_row("people; steps", f"{content['trajectories']:,}; {content['steps']:,}")
    for name, number in count_lines(content["counts"]):
        rows.add_row(f"  {name}", number)
    judged = content["held_out"]
    heading = f"held out: {judged['trajectories']} people, {judged['steps']:,} steps"
    scores = table(heading, "nats a step", right=["nats a step"])
    scores.add_row("velocity-direction model", f"{judged['model']:.3f}")
    scores.add_row(f"the same on the grid, {judged['directions']} directions", f"{judged['on_grid']:.3f}")
    scores.add_row("random walk", f"{judged['random_walk']:.3f}")
    scores.add_row("constant velocity", f"{judged['constant_velocity']:.3f}")
    shown: list[RenderableType] = [rows, scores]
    if written:
        shown.append(f"Written: {', '.join(written)}")
    return shown
