"""Tracks at the pace of the control loop."""

from __future__ import annotations

import math

import numpy as np

from surveillance_domain.trajectories.tracks import Track

__all__ = ["MOST_STEPS", "resampled"]

MOST_STEPS = 50_000_000
"""More positions are not laid out."""

_ROUNDING = 1e-6
"""Of a step: a track that ends so little before one reaches it."""


def resampled(track: Track, step_s: float, origin_s: float | None = None) -> Track | None:
    """The track at every ``step_s`` seconds, by straight lines between its points.

    Parameters
    ----------
    track : Track
    step_s : float
    origin_s : float, optional
        The raster's zero, common to all tracks; without it each track starts at its own first point.

    Returns
    -------
    Track or None
        ``None`` where the raster meets the track not at all.

    Raises
    ------
    ValueError
        For a track of more than `MOST_STEPS`.
    """
    first, last = float(track.times_s[0]), float(track.times_s[-1])
    origin = first if origin_s is None else origin_s
    begin = math.ceil((first - origin) / step_s - _ROUNDING)
    end = math.floor((last - origin) / step_s + _ROUNDING)
    if end < begin:
        return None
    if end - begin >= MOST_STEPS:
        raise ValueError(
            f"id {track.name} goes on from {first:g} to {last:g} s without a break, which is more than {MOST_STEPS:,} "
            f"steps of {step_s:g} s; give a smaller --max-gap-s, or mend the times"
        )
    times = origin + step_s * np.arange(begin, end + 1)
    points = np.stack([np.interp(times, track.times_s, column) for column in track.points_m.T], axis=1)
    return Track(track.name, times, points)
