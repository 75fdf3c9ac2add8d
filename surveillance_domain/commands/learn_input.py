"""The recordings that ``surveillance learn`` is given: each once, and all their people together."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from surveillance_domain.trajectories.tracks import Track, Tracks

__all__ = ["read_all", "together"]

_SHOWN = 5
_UNEVEN = 0.01
"""Of a recording's usual step, which a clock that is not quite even does not tell better."""


def read_all(files: Sequence[Path], read: Callable[[Path], Tracks]) -> tuple[dict[Path, Tracks], list[str]]:
    """Every recording once, and of those passed over, why: people counted twice would be held out from themselves."""
    found: dict[Path, Tracks] = {}
    holding: dict[str, Path] = {}
    told = [
        f"{path}: given {files.count(path)} times; taken once" for path in dict.fromkeys(files) if files.count(path) > 1
    ]
    for path in dict.fromkeys(files):
        tracks = read(path)
        before = holding.setdefault(_content_of(tracks), path)
        if before == path:
            found[path] = tracks
            told += _twice(path, tracks, {other: found[other] for other in found if other != path})
        else:
            told.append(
                f"{path}: holds the same as {before}, to the last point; passed over, as its people would count twice"
            )
    return found, told


def _twice(path: Path, tracks: Tracks, others: Mapping[Path, Tracks]) -> list[str]:
    """Who of a recording is in one of the others, too, told in rounded numbers or in part."""
    from surveillance_domain.trajectories.copies import WITHIN_M, copied

    told = []
    for other, before in others.items():
        names = copied(tracks.tracks, before.tracks)
        if names:
            more = f" and {len(names) - _SHOWN:,} more" if len(names) > _SHOWN else ""
            told.append(
                f"{path}: {len(names):,} of its {len(tracks.people):,} people are within {100 * WITHIN_M:g} cm of "
                f"somebody in {other} at the same times, as if these were one: id {', '.join(names[:_SHOWN])}{more}; "
                "they count twice, and somebody held out may be learned from: give every person in one file only"
            )
    return told


def _content_of(tracks: Tracks) -> str:
    """A digest of times and places, whatever people and files are called."""
    from surveillance_domain.trajectories.transitions import in_order_of_content

    digest = hashlib.sha256()
    for track in in_order_of_content(tracks.tracks):
        digest.update(len(track.times_s).to_bytes(8, "big") + track.times_s.tobytes() + track.points_m.tobytes())
    return digest.hexdigest()


def together(found: Mapping[Path, Tracks], step_s: float) -> list[Track]:
    """The tracks of all files; people of different files are different people.

    Raises
    ------
    InputError
        If the step is finer than a recording: what lies between its points is interpolated, and never turns.
    """
    from dataclasses import replace

    tracks: list[Track] = []
    for path, one in found.items():
        if step_s < one.frame_s * (1 - _UNEVEN):
            raise InputError(f"{path}: recorded every {one.frame_s:.3g} s; expected a --step-s no shorter than that")
        tracks += [replace(track, name=f"{track.name} of {path}") for track in one.tracks]
    if len({track.name for track in tracks}) < 2:
        raise InputError(f"{', '.join(map(str, found))}: one person alone; expected two or more, one to be held out")
    return tracks
