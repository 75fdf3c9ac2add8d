"""From rows to tracks: duplicates, gaps, jumps and other units are found, dealt with in one stated way, and counted."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.conventions import Conventions, on_floor
from surveillance_domain.trajectories.rasters import usual_step
from surveillance_domain.trajectories.rows import Rows, TrajectoryError
from surveillance_domain.trajectories.tracks import Counts, Track, Tracks

__all__ = ["Limits", "cleaned"]

_WALKING_MPS = (0.4, 2.2)
_MOVING_MPS = 0.3
_RATES_AGREE = 0.1


@dataclass(frozen=True)
class Limits:
    """Where a track is cut.

    Attributes
    ----------
    gap_s : float
        Longest time without a point that is filled by interpolation.
    fastest_mps : float
        Faster moves are jumps.
    """

    gap_s: float = 2.0
    fastest_mps: float = 10.0


def cleaned(rows: Rows, conventions: Conventions, limits: Limits, source: str) -> Tracks:
    """Tracks in metres and seconds.

    Raises
    ------
    TrajectoryError
        Without a rate of frames, without a track of two points, or where most people move faster than anybody can.
    """
    rate = conventions.frames_per_s or rows.frames_per_s
    step = usual_step(rows)
    if step is None:
        raise TrajectoryError(source, (Fault("", "no track of two points", "people who are seen more than once"),))
    if rate is None:
        raise TrajectoryError(source, (Fault("", "no rate of frames", _rate_wanted(rows, conventions)),))
    points = on_floor(rows.points, conventions)
    if not np.isfinite(points).all():
        line = int(rows.lines[~np.isfinite(points).all(axis=1)][0])
        raise TrajectoryError(source, (Fault(f"line {line}", "a point on the horizon of the homography", "the floor"),))
    counts: Counter[str] = Counter(rows=len(points), people=len(rows.names))
    tracks: list[Track] = []
    for number, name in enumerate(rows.names):
        own = np.flatnonzero(rows.tracks == number)
        frames, places = _in_order(rows.frames[own], points[own], counts)
        tracks += _parts(name, frames / rate, places, step / rate, limits, counts)
    if counts["other_units"] * 2 > len(rows.names):
        pace = float(np.median(_speeds(rows, points, rate)))
        raise TrajectoryError(source, (Fault("", f"a median speed of {pace:.3g} m/s", _UNITS),))
    if not tracks:
        raise TrajectoryError(source, (Fault("", "no track of two points", "people who are seen more than once"),))
    warnings = _warnings(rows, points, rate, conventions, tracks)
    return Tracks(tuple(tracks), step / rate, Counts(**counts), warnings)


_UNITS = (
    "metres on the floor; if these are pixels or centimetres, give --metres-per-unit or --homography, "
    "and see that --frames-per-s is right"
)


def _in_order(
    frames: Float[np.ndarray, " points"], places: Float[np.ndarray, "points 2"], counts: Counter[str]
) -> tuple[Float[np.ndarray, " kept"], Float[np.ndarray, "kept 2"]]:
    """One person's rows by frame, each frame once; frames with two places are left out."""
    counts["out_of_order_rows"] += int((np.diff(frames) < 0).sum())
    order = np.argsort(frames, kind="stable")
    frames, places = frames[order], places[order]
    again = np.diff(frames) == 0
    if not again.any():
        return frames, places
    same = again & (np.abs(np.diff(places, axis=0)) <= 1e-9).all(axis=1)
    contradictory = np.unique(frames[1:][again & ~same])
    counts["repeated_rows"] += int(same.sum())
    counts["contradictory_frames"] += len(contradictory)
    kept = np.concatenate([[True], ~again]) & ~np.isin(frames, contradictory)
    return frames[kept], places[kept]


def _parts(
    name: str,
    times_s: Float[np.ndarray, " points"],
    places: Float[np.ndarray, "points 2"],
    frame_s: float,
    limits: Limits,
    counts: Counter[str],
) -> list[Track]:
    """The track, cut at long gaps and jumps."""
    passed = np.diff(times_s)
    speeds = np.hypot(*np.diff(places, axis=0).T) / passed
    if len(speeds) and np.median(speeds) > limits.fastest_mps:
        counts["other_units"] += 1
        return []
    missing = passed > 1.5 * frame_s
    cut = missing & (passed > limits.gap_s + 1e-9)
    jumped = ~cut & (speeds > limits.fastest_mps)
    counts["gaps_cut"] += int(cut.sum())
    counts["gaps_filled"] += int((missing & ~cut & ~jumped).sum())
    counts["jumps"] += int(jumped.sum())
    made = []
    for part in np.split(np.arange(len(times_s)), np.flatnonzero(cut | jumped) + 1):
        if len(part) > 1:
            made.append(Track(name, times_s[part], places[part]))
        else:
            counts["single_points"] += 1
    return made


def _speeds(rows: Rows, points: Float[np.ndarray, "rows 2"], rate: float) -> Float[np.ndarray, " moves"]:
    """Metres a second between successive rows of one person."""
    order = np.lexsort([rows.frames, rows.tracks])
    passed = np.diff(rows.frames[order]) / rate
    moves: Bool[np.ndarray, " pairs"] = (np.diff(rows.tracks[order]) == 0) & (passed > 0)
    return np.hypot(*np.diff(points[order], axis=0)[moves].T) / passed[moves]


def _warnings(
    rows: Rows, points: Float[np.ndarray, "rows 2"], rate: float, conventions: Conventions, tracks: list[Track]
) -> tuple[str, ...]:
    found = []
    if conventions.frames_per_s and rows.frames_per_s and not np.isclose(rate, rows.frames_per_s, rtol=1e-3):
        found.append(f"the file itself says {rows.frames_per_s:g} frames a second; {rate:g} was given and is used")
    told = _rate_of_velocities(rows, conventions)
    if told is not None and abs(told / rate - 1) > _RATES_AGREE:
        found.append(f"the file's own velocities speak of {told:.3g} frames a second; {rate:g} is used")
    paces = np.concatenate([np.hypot(*np.diff(t.points_m, axis=0).T) / np.diff(t.times_s) for t in tracks])
    moving = paces[paces > _MOVING_MPS]
    if moving.size:
        pace = float(np.median(moving))
        if not _WALKING_MPS[0] <= pace <= _WALKING_MPS[1]:
            found.append(f"people who move go {pace:.3g} m/s, which is not a walk: are frame rate and unit right?")
    return tuple(found)


def _rate_of_velocities(rows: Rows, conventions: Conventions) -> float | None:
    """The rate at which a file's velocities agree with its positions, where both are in metres."""
    if rows.velocities is None or conventions.metres_per_unit is not None or conventions.homography is not None:
        return None
    order = np.lexsort([rows.frames, rows.tracks])
    told = np.hypot(*rows.velocities[order].T)[1:]
    a_frame = np.diff(rows.frames[order])
    fits = (np.diff(rows.tracks[order]) == 0) & (a_frame > 0)
    moved = np.hypot(*np.diff(rows.points[order], axis=0)[fits].T) / a_frame[fits]
    clear = (moved > 0) & (told[fits] > _MOVING_MPS)
    return float(np.median(told[fits][clear] / moved[clear])) if clear.any() else None


def _rate_wanted(rows: Rows, conventions: Conventions) -> str:
    told = _rate_of_velocities(rows, conventions)
    hint = f"; its own velocities speak of about {told:.3g}" if told is not None else ""
    return f"--frames-per-s F, or frames_per_s in a sidecar (ETH counts 15 a second, UCY 25{hint})"
