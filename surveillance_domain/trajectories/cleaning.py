"""From rows to tracks: duplicates, gaps, jumps and other units are found, dealt with in one stated way, and counted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.conventions import Conventions, on_floor
from surveillance_domain.trajectories.findings import Limits, findings
from surveillance_domain.trajectories.horizon import beyond_earth, beyond_horizon
from surveillance_domain.trajectories.plausibility import finer_than_seconds, rate_wanted, speeds, warnings_of
from surveillance_domain.trajectories.rasters import usual_step
from surveillance_domain.trajectories.rows import Rows, TrajectoryError
from surveillance_domain.trajectories.tracks import Counts, Track, Tracks

__all__ = ["Limits", "cleaned"]

_SAME_PLACE = 1e-9
_EXACT_S = 1e-9
_DIGITS = 6
_Numbers = Int[np.ndarray, "..."]


def cleaned(rows: Rows, conventions: Conventions, limits: Limits, source: str) -> Tracks:
    """Tracks in metres and seconds.

    Raises
    ------
    TrajectoryError
        Without a rate of frames, without a track of two points, where points lie beyond the horizon of the homography
        or beyond all places, where times are hardly seconds and were not said to be, or where most people move faster
        than anybody can.
    """
    rate = 1.0 if rows.timed else conventions.frames_per_s or rows.frames_per_s
    unordered = _unordered(rows)
    rows = _by_person_and_frame(rows)
    even = replace(rows, frames=_counted_evenly(rows.frames, rate or 1.0))
    step = usual_step(even)
    if step is None:
        raise TrajectoryError(source, (Fault("", "no track of two points", "people who are seen more than once"),))
    if rate is None:
        raise TrajectoryError(source, (Fault("", "no rate of frames", rate_wanted(even, conventions, source)),))
    points = on_floor(rows.points, conventions)
    impossible = beyond_horizon(rows, conventions) or beyond_earth(rows, points)
    if impossible is not None:
        raise TrajectoryError(source, (impossible,))
    finer = finer_than_seconds(even, points, step, conventions)
    if finer is not None and "time_s" not in (conventions.columns or {}):
        raise TrajectoryError(source, (finer.fault,))
    seconds = even.frames / rate
    kept, repeated, contradictory = _once_a_frame(rows, points)
    cut = _cut(rows.tracks[kept], seconds[kept], points[kept], step / rate, limits)
    met = {
        "repeated_rows": repeated,
        "contradictory_frames": contradictory,
        "out_of_order_rows": unordered,
        "gaps_filled": kept[cut.filled],
        "gaps_cut": kept[cut.gaps],
        "jumps": kept[cut.jumps],
        "single_points": kept[cut.single],
        "other_units": kept[cut.other_units],
    }
    names = {int(rows.tracks[kept[part[0]]]) for part in cut.parts}
    told = findings(rows, met, names, limits)
    if len(cut.other_units) * 2 > len(rows.names):
        pace = float(np.median(speeds(even, points, rate)))
        raise TrajectoryError(source, (Fault("", f"a median speed of {pace:.3g} m/s", _UNITS),))
    if not cut.parts:
        faults = (Fault("", one.message.rstrip("."), "tracks that go on") for one in told)
        none = Fault("", "no track of two points that is left", "people who are seen more than once")
        raise TrajectoryError(source, (none, *faults))
    tracks = tuple(
        Track(rows.names[rows.tracks[at[0]]], seconds[at], points[at], rows.lines[at])
        for at in (kept[part] for part in cut.parts)
    )
    counts = Counts(
        rows=len(points),
        people=len(rows.names),
        contradictory_people=len(rows.names) - len(np.unique(rows.tracks[kept])),
        **{kind: len(at) for kind, at in met.items()},
    )
    doubts = () if finer is None else (finer.warning,)
    return Tracks(tracks, step / rate, counts, (*doubts, *warnings_of(even, rate, conventions, tracks)), told)


_UNITS = (
    "metres on the floor; if these are pixels or centimetres, give --metres-per-unit or --homography, "
    "and see that --frames-per-s is right"
)


def _unordered(rows: Rows) -> Int[np.ndarray, " found"]:
    """Rows of an earlier frame than the same person's row before, numbered as `_by_person_and_frame` has them."""
    as_written = np.argsort(rows.tracks, kind="stable")
    back = (np.diff(rows.tracks[as_written]) == 0) & (np.diff(rows.frames[as_written]) < 0)
    place = np.empty(len(as_written), dtype=np.int64)
    place[np.lexsort([rows.frames, rows.tracks])] = np.arange(len(as_written))
    return place[as_written[1:][back]]


def _by_person_and_frame(rows: Rows) -> Rows:
    order = np.lexsort([rows.frames, rows.tracks])
    return replace(
        rows,
        frames=rows.frames[order],
        tracks=rows.tracks[order],
        points=rows.points[order],
        lines=rows.lines[order],
        velocities=None if rows.velocities is None else rows.velocities[order],
    )


def _counted_evenly(frames: Float[np.ndarray, " rows"], rate: float) -> Float[np.ndarray, " rows"]:
    """Frames, or seconds, from the first on where they are so large (Unix times) that their last digits are noise."""
    if np.spacing(np.abs(frames).max() / rate) <= _EXACT_S:
        return frames
    return np.asarray((frames - frames.min()).round(_DIGITS))


def _once_a_frame(
    rows: Rows, points: Float[np.ndarray, "rows 2"]
) -> tuple[Int[np.ndarray, " kept"], Int[np.ndarray, " repeated"], Int[np.ndarray, " contradictory"]]:
    """Rows to keep, one for each person and frame; rows that repeat one; the first of each frame with two places."""
    again = np.concatenate([[False], (np.diff(rows.tracks) == 0) & (np.diff(rows.frames) == 0)])
    alike = np.concatenate([[False], (np.abs(np.diff(points, axis=0)) <= _SAME_PLACE).all(axis=1)])
    frame = np.cumsum(~again) - 1
    first = np.flatnonzero(~again)
    two_places = np.zeros(len(first), dtype=bool)
    two_places[frame[again & ~alike]] = True
    return first[~two_places], np.flatnonzero(again & alike), first[two_places]


@dataclass(frozen=True, eq=False)
class _Cut:
    """Parts of tracks, and where they were cut: the numbers of points before and after which something is."""

    parts: list[_Numbers]
    filled: _Numbers
    gaps: _Numbers
    jumps: _Numbers
    single: _Numbers
    other_units: _Numbers


def _cut(
    people: Int[np.ndarray, " points"],
    times_s: Float[np.ndarray, " points"],
    places: Float[np.ndarray, "points 2"],
    frame_s: float,
    limits: Limits,
) -> _Cut:
    """Everybody's points in parts without long gaps and jumps; people most of whose moves are too fast are left out."""
    own = np.diff(people) == 0
    passed = np.where(own, np.diff(times_s), 1.0)
    paces = np.hypot(*np.diff(places, axis=0).T) / passed
    starts = np.flatnonzero(np.concatenate([[True], ~own]))
    ends = np.append(starts[1:], len(people))
    too_fast = np.zeros(len(people), dtype=bool)
    other_units = []
    for start, end in zip(starts.tolist(), ends.tolist(), strict=True):
        if end - start > 1 and np.median(paces[start : end - 1]) > limits.fastest_mps:
            other_units.append(start)
            too_fast[start:end] = True
    own &= ~too_fast[1:]
    missing = own & (passed > 1.5 * frame_s)
    cut = missing & (passed > limits.gap_s + 10.0**-_DIGITS)
    jumped = own & ~cut & (paces > limits.fastest_mps)
    breaks = np.flatnonzero(~own | cut | jumped) + 1
    begin = np.concatenate([[0], breaks])[: len(people)]
    length = np.diff(np.append(begin, len(people)))
    usable = ~too_fast[begin]
    whole = usable & (length > 1)
    return _Cut(
        parts=[np.arange(b, b + n) for b, n in zip(begin[whole].tolist(), length[whole].tolist(), strict=True)],
        filled=np.flatnonzero(missing & ~cut & ~jumped) + 1,
        gaps=np.flatnonzero(cut) + 1,
        jumps=np.flatnonzero(jumped) + 1,
        single=begin[usable & (length == 1)],
        other_units=np.array(other_units, dtype=np.int64),
    )
