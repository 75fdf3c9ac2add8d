"""People of one recording who are in another, too: at the same times at the same places, but for rounding."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from surveillance_domain.trajectories.tracks import Track

__all__ = ["WITHIN_M", "copied"]

WITHIN_M = 0.1
"""Places told to a centimetre, or on another raster of times, mostly differ by less; two people never do for long."""
_LOOKS = 9
_MOST_IN_COMMON = 0.5
"""Of the shorter of two tracks: so much of the time must both be there."""


def copied(tracks: Sequence[Track], others: Sequence[Track]) -> tuple[str, ...]:
    """Names of those who are somebody of the others: as long as both are there, and that for half of the shorter track.

    Both recordings are taken to be on one clock and in one frame.
    """
    if not others:
        return ()
    begin, end = (np.array([track.times_s[at] for track in others]) for at in (0, -1))
    low, high = (np.stack([ends(track.points_m, axis=0) for track in others]) for ends in (np.min, np.max))
    found: dict[str, None] = {}
    for track in tracks:
        if track.name in found:
            continue
        first, last = float(track.times_s[0]), float(track.times_s[-1])
        common = np.minimum(end, last) - np.maximum(begin, first)
        near = (low <= track.points_m.max(axis=0) + WITHIN_M) & (high >= track.points_m.min(axis=0) - WITHIN_M)
        alike = near.all(axis=1) & (common >= _MOST_IN_COMMON * np.minimum(end - begin, last - first)) & (common > 0)
        if any(_same(track, others[number]) for number in np.flatnonzero(alike).tolist()):
            found[track.name] = None
    return tuple(found)


def _same(track: Track, other: Track) -> bool:
    """Whether two are at one place whenever looked at while both are there."""
    begin, end = (pick(track.times_s[at], other.times_s[at]) for pick, at in ((max, 0), (min, -1)))
    times = np.linspace(begin, end, _LOOKS)
    away = np.hypot(*(_at(track, times) - _at(other, times)).T)
    return bool((away <= WITHIN_M).all())


def _at(track: Track, times: Float[np.ndarray, " looks"]) -> Float[np.ndarray, "looks 2"]:
    return np.stack([np.interp(times, track.times_s, column) for column in track.points_m.T], axis=1)
