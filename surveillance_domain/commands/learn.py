"""``surveillance learn``: the motion model's numbers, learned from recorded people."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer, side_console
from surveillance_domain.commands.options import Progress, Seed
from surveillance_domain.commands.recordings import (
    Columns,
    FastestMps,
    FramesPerS,
    HomographyFile,
    MaxGap,
    MetresPerUnit,
    about,
    conventions,
    placement_of,
    read_tracks,
)

if TYPE_CHECKING:
    import numpy as np

    from surveillance_domain.site.site import Site
    from surveillance_domain.trajectories.learning import Learned
    from surveillance_domain.trajectories.prior import PlacedPrior
    from surveillance_domain.trajectories.staging import Placement

__all__ = ["learn"]

_OFTEN_IMPOSSIBLE = 0.05
_FEW_SPEEDS = 5
_WORK = 3
"""Reading is one part of so many."""


def learn(
    trajectories: Annotated[
        list[Path],
        typer.Argument(
            metavar="TRAJECTORIES…",
            help="Files of recorded people; FILE.toml beside a FILE, its sidecar, may say how that file is meant.",
        ),
    ],
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
        Path | None,
        typer.Option(metavar="SITE.toml", help="A site file that gets these sigmas and speeds, and the placed prior."),
    ] = None,
    offset_m: Annotated[
        str | None,
        typer.Option(metavar="X,Y", help="With --write: where in the site the recording's origin lies; 0,0: the same."),
    ] = None,
    rotate_deg: Annotated[
        float | None, typer.Option(help="With --write: of the recording, counter-clockwise about its origin.")
    ] = None,
    picture: Annotated[
        Path | None, typer.Option(metavar="PNG", help="Predicted beside real displacements; an SVG beside it.")
    ] = None,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Learn how people move: sigmas of direction and speed, a set of speeds, a prior, and how well they foretell."""
    import numpy as np

    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.commands.learn_answer import carried, learned_content, shown_learned
    from surveillance_domain.commands.learn_input import read_all, together
    from surveillance_domain.commands.learn_site import checked_site, of_turning, of_walls, write_learned
    from surveillance_domain.commands.progress import progress_bar
    from surveillance_domain.trajectories.learning import Wanted, learn_motion

    for name, value in (("--step-s", step_s), ("--cell-m", cell_m)):
        if not 0 < value < float("inf"):
            raise InputError(f"{name} {value:g}: expected a number above 0")
    if picture is not None and (picture.suffix.lower() not in (".png", ".svg") or picture.is_dir()):
        raise InputError(f"--picture {picture}: expected the name of a file that ends in .png")
    placement = _placement(offset_m, rotate_deg, write, len(set(trajectories)))
    site = None if write is None else checked_site(write, step_s, cell_m, placement is not None)
    given = conventions(frames_per_s, metres_per_unit, homography, columns)
    if picture is not None:
        ready_folder(picture.parent)
    rng = np.random.default_rng(seed)
    size = sum(path.stat().st_size for path in set(trajectories) if path.is_file())
    with progress_bar("reading", _WORK * size, progress) as advance:
        found, passed_over = read_all(
            trajectories, lambda path: read_tracks(path, given, max_gap_s, fastest_mps, advance)
        )
        for told in passed_over:
            _warn(told)
        tracks = together(found, step_s)
        wanted = Wanted(step_s, cell_m, speeds, directions, held_out, prior=len(found) == 1)
        with about(found):
            learned = learn_motion(
                tracks, wanted, rng, lambda share, doing: advance(round(share * (_WORK - 1) * size), doing)
            )
            placed = None if site is None or placement is None else _placed(learned, site, placement)
    content = learned_content(found, passed_over, learned, wanted, placed)
    written = []
    if picture is not None:
        written += _draw(learned, picture, [path.name for path in found], rng)
    if write is not None and site is not None:
        told_of_walls = of_walls(site, learned.fit)
        written += write_learned(site, learned.fit, placed)
        if told_of_walls is not None:
            content["warnings"].append(told_of_walls)
            _warn(told_of_walls)
        if placed is None:
            _tell_of_prior(write, len(found))
    coarse = (
        of_turning(directions, learned.fit, "--directions {}")
        if site is None
        else of_turning(site.targets.directions, learned.fit, f"directions = {{}} in [targets] of {site.path}")
    )
    if coarse is not None:
        content["warnings"].append(coarse)
        _warn(coarse)
    if learned.judged.impossible > _OFTEN_IMPOSSIBLE:
        _warn(
            f"{learned.judged.impossible:.0%} of the held-out steps end, in part, in cells that {directions} "
            f"steps of direction and {len(learned.fit.speeds_mps)} of speed on cells of {cell_m:g} m cannot reach: "
            "take more directions or speeds, larger cells or shorter steps"
        )
    content |= {"written": written, **carried(found, seed)}
    answer(content, shown_learned(content, learned.prior, placed), as_json=as_json)


def _warn(text: str) -> None:
    side_console().print(text, style="yellow", soft_wrap=True)


def _placement(offset_m: str | None, rotate_deg: float | None, write: Path | None, files: int) -> Placement | None:
    """Where the recording lies in the site, if it was said."""
    if offset_m is None and rotate_deg is None:
        return None
    if write is None:
        raise InputError("--offset-m and --rotate-deg place the recording into a site: expected --write SITE.toml too")
    if files > 1:
        raise InputError(
            f"--offset-m and --rotate-deg with {files} files, each in a frame of its own: expected one file, whose "
            "people tell where in the site they are"
        )
    return placement_of("0,0" if offset_m is None else offset_m, rotate_deg or 0.0)


def _placed(learned: Learned, site: Site, placement: Placement) -> PlacedPrior:
    """The prior in the site; what was not counted is told."""
    from surveillance_domain.trajectories.prior import placed_prior

    prior = placed_prior(learned.everyone.points_m, site.grid, placement)
    if prior.off_map or prior.in_walls:
        total = prior.points + prior.off_map + prior.in_walls
        _warn(
            f"prior: {prior.off_map:,} of {total:,} positions fall off the map and {prior.in_walls:,} into walls, and "
            "are not counted; is the recording placed rightly (--offset-m, --rotate-deg)?"
        )
    return prior


def _tell_of_prior(write: Path, files: int) -> None:
    because = (
        f"{files} recordings have no common frame: learn it from one of them"
        if files > 1
        else "where the recording lies in the site was not said: give --offset-m X,Y and --rotate-deg R "
        "(--offset-m 0,0 if both have the same frame)"
    )
    _warn(f"{write}: the prior over cells was not written, since {because}")


def _draw(learned: Learned, picture: Path, names: Sequence[str], rng: np.random.Generator) -> list[str]:
    import numpy as np

    from surveillance_domain.pictures.motion_fit import FittedMotion, SeenWhere, draw_motion_fit
    from surveillance_domain.pictures.style import save_figure
    from surveillance_domain.trajectories.transitions import STILL_MPS

    fit, judging, prior = learned.judged_fit, learned.judging, learned.prior
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
    reported = learned.fit
    few = len(reported.speeds_mps) <= _FEW_SPEEDS
    note = (
        "The curves were learned without the people held out.\n"
        f"Reported, from everybody: σ of the direction {reported.sigma_direction_deg:.2f}°, "
        f"of the speed {reported.sigma_speed_mps:.3f} m/s"
        + (f", speeds {', '.join(f'{speed:g}' for speed in reported.speeds_mps)} m/s" if few else "")
    )
    where = None if prior is None else SeenWhere(prior.origin_m, prior.cell_m, prior.probability)
    figure = draw_motion_fit(fitted, f"Learned from {', '.join(names)}", rng, note, where)
    return [str(path) for path in save_figure(figure, picture)]
