"""``surveillance replay``: the cameras against recorded people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import COMMAND_LINE, INTERRUPTED, AsJson, InputError, answer, side_console, table
from surveillance_domain.commands.options import (
    CellNoise,
    DetectionProbability,
    Overrides,
    Progress,
    Seed,
    SiteName,
    Steps,
    input_checked,
    overrides,
    read_controllers,
)
from surveillance_domain.commands.recordings import (
    Columns,
    FastestMps,
    FramesPerS,
    HomographyFile,
    MaxGap,
    MetresPerUnit,
    OffsetM,
    RotateDeg,
    about,
    conventions,
    count_lines,
    digest_of,
    placement_of,
    read_tracks,
)
from surveillance_domain.commands.run_answer import measured, shown_runs, write_run

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.experiments.recording import Recording
    from surveillance_domain.experiments.replay import Replay
    from surveillance_domain.experiments.runs import Run
    from surveillance_domain.site.site import Site
    from surveillance_domain.trajectories.staging import Stage, Staged
    from surveillance_domain.trajectories.tracks import Tracks

__all__ = ["replay"]

_COARSER = 1.01
"""Of a step: a recording by a clock that is not quite even is not coarser for that."""


def replay(
    site: SiteName,
    trajectories: Annotated[
        Path,
        typer.Argument(
            metavar="TRAJECTORIES",
            help="A file of recorded people; FILE.toml beside it, its sidecar, may say how it is meant.",
        ),
    ],
    controller: Annotated[
        str, typer.Option(help="pomdp, mp, msp, sys, stat, full-information, clairvoyant.")
    ] = "pomdp",
    offset_m: OffsetM = "0,0",
    rotate_deg: RotateDeg = 0.0,
    frames_per_s: FramesPerS = None,
    metres_per_unit: MetresPerUnit = None,
    homography: HomographyFile = None,
    columns: Columns = None,
    max_gap_s: MaxGap = 2.0,
    fastest_mps: FastestMps = 10.0,
    start_s: Annotated[float, typer.Option(min=0, help="Seconds of the recording that are passed over.")] = 0.0,
    steps: Steps = 100,
    runs: Annotated[
        int | None,
        typer.Option(min=1, help="Pieces of so many steps, one after the other; default: as many as there are."),
    ] = None,
    seed: Seed = 0,
    detection_probability: DetectionProbability = None,
    cell_noise_m: CellNoise = None,
    option: Overrides = None,
    out: Annotated[Path | None, typer.Option(help="Folder for an animation of the first run, and tables.")] = None,
    progress: Progress = None,
    as_json: AsJson = False,
) -> None:
    """Let one controller watch recorded people, and say which share of them it observed."""
    from surveillance_domain.commands.folder import ready_folder
    from surveillance_domain.experiments.variants import ALL_NAMES
    from surveillance_domain.site.load import load_site
    from surveillance_domain.trajectories.staging import staged, windows

    (name, *others) = read_controllers(controller)
    if others:
        raise InputError(f"--controller {controller}: expected one controller")
    placement = placement_of(offset_m, rotate_deg)
    given = conventions(frames_per_s, metres_per_unit, homography, columns)
    changed = overrides(option, detection_probability, cell_noise_m)
    with input_checked():
        found = load_site(site).with_overrides(**changed)
    tracks = read_tracks(trajectories, given, max_gap_s, fastest_mps)
    with about([trajectories]):
        stage = staged(tracks.tracks, found.grid, placement, found.control.step_s)
        pieces, empty = windows(stage, steps, runs, round(min(start_s / found.control.step_s, stage.times)))
    if not pieces:
        raise InputError(f"{trajectories}: nobody is on the map after --start-s {start_s:g}")
    warnings = [*_coarse(tracks, found), *_scattered(tracks), *_misplaced(stage), *_without_doors(found)]
    for told in warnings:
        side_console().print(told, style="yellow", soft_wrap=True)
    if out is not None:
        ready_folder(out)
    done, recording, first, interrupted = _watched(found, pieces, name, seed, out is not None, progress)
    content = {
        "site": found.name,
        "controller": name,
        "targets": len({person for piece in pieces for person in piece.people}),
        "steps": len(pieces[0].path_m) - 1,
        **measured(done),
        "truth": "recorded",
        **changed,
        "targets_per_run": [len(piece.people) for piece in pieces],
        "empty_pieces": empty,
        "people": _comings(pieces),
        "placed": {
            "offset_m": list(placement.offset_m),
            "rotate_deg": rotate_deg,
            "off_map": stage.off_map,
            "in_walls": stage.in_walls,
            "moved_out_of_walls": stage.moved_out_of_walls,
        },
        "counts": tracks.counts.as_dict(),
        "warnings": [*tracks.warnings, *warnings],
        "faults": [asdict(finding) for finding in tracks.findings],
        "interrupted": interrupted,
    }
    content |= _carried(found, trajectories, seed)
    if out is not None:
        heading = f"{found.name}, {trajectories.name}, controller {ALL_NAMES[name]}"
        write_run(out, first.surveillance if first is not None else None, recording, heading, content)
    answer(content, _shown(content, out), as_json=as_json)
    if interrupted:
        raise typer.Exit(INTERRUPTED)


def _coarse(tracks: Tracks, site: Site) -> Iterator[str]:
    """That people of the recording walk along straight lines between its points, which no model foretells."""
    step_s = site.control.step_s
    if tracks.frame_s > step_s * _COARSER:
        yield (
            f"recorded every {tracks.frame_s:.3g} s, and the site has step_s = {step_s:g}: between the points people "
            "go along straight lines, as nobody does; expected a recording no coarser than a step"
        )


def _scattered(tracks: Tracks) -> Iterator[str]:
    """That hardly anything but emptiness lies between the first and the last of the recording."""
    from surveillance_domain.trajectories.far_away import long_pause

    pause = long_pause(tracks.tracks)
    if pause is not None:
        yield f"{pause}; these pieces of the recording are empty and left out: are all times right, and in one unit?"


def _misplaced(stage: Staged) -> Iterator[str]:
    """That most of a recording lies where nobody can be watched."""
    lost = stage.off_map + stage.in_walls
    total = lost + stage.positions
    if 2 * lost > total:
        told = f"{stage.off_map:,} of {total:,} positions fall off the map and {stage.in_walls:,} into walls"
        yield f"{told}, where nobody is watched; are --offset-m and --rotate-deg right?"


def _without_doors(site: Site) -> Iterator[str]:
    if not site.targets.doors:
        yield f"site {site.name} has no [[targets.doors]]: everybody is believed to be on the map all the time"


def _watched(
    site: Site, pieces: Sequence[Stage], controller: str, seed: int, record: bool, progress: bool | None
) -> tuple[dict[int, Run], Recording | None, Replay | None, bool]:
    """All runs that were finished, the first of them recorded, and whether Ctrl-C cut it short."""
    from surveillance_domain.commands.progress import progress_bar
    from surveillance_domain.experiments.recording import recorded
    from surveillance_domain.experiments.replay import prepared_replay, replay_run

    done: dict[int, Run] = {}
    recording, first = None, None
    total = sum(len(piece.path_m) - 1 for piece in pieces)
    with progress_bar(f"replaying in {site.name}", total, progress) as advance:
        try:
            for number, piece in enumerate(pieces):
                with input_checked():
                    prepared = prepared_replay(site, piece, controller, seed, number)
                if record and number == 0:
                    first = prepared
                    recording = recorded(prepared.surveillance, prepared.world, prepared.controller, prepared.steps)
                    done[number] = recording.run
                    advance(prepared.steps)
                else:
                    done[number] = replay_run(prepared, lambda step: advance(1))
        except KeyboardInterrupt:
            return done, recording, first, True
    return done, recording, first, False


def _comings(pieces: Sequence[Stage]) -> dict[str, int]:
    from surveillance_domain.experiments.replay import comings

    found = [comings(piece) for piece in pieces]
    return {
        "entered_late": sum(one.late for one in found),
        "left_early": sum(one.early for one in found),
        "there_throughout": sum(one.throughout for one in found),
    }


def _carried(site: Site, trajectories: Path, seed: int) -> dict[str, Any]:
    from factored_pomdp.provenance import provenance

    inputs = {site.name: f"sha256:{site.digest}", str(trajectories): digest_of(trajectories)}
    carried = provenance(COMMAND_LINE.get(), inputs, seed)
    return {**carried, "provenance": carried}


def _shown(content: Mapping[str, Any], out: Path | None) -> list[RenderableType]:
    rows = table("replayed", "found", right=["found"])
    for key in ("site", "controller", "targets", "steps", "runs"):
        rows.add_row(key, str(content[key]))
    points = {key: content["placed"][key] for key in ("off_map", "in_walls", "moved_out_of_walls")}
    for what, number in (*count_lines(content["people"]), *count_lines(points), *count_lines(content["counts"])):
        rows.add_row(f"  {what}", number)
    return shown_runs(rows, content, out)
