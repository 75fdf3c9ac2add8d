"""The raster of frames on which a file is annotated: every sixth, every tenth, every one."""

from __future__ import annotations

import numpy as np

from surveillance_domain.trajectories.rows import Rows

__all__ = ["usual_step"]


_CLEAR = 0.2
"""Share of the differences that makes one the usual step by itself."""
_ALIKE = 0.25
"""Differences so near to another, in parts of it, are the same step of a clock that is not quite even."""


def usual_step(rows: Rows) -> float | None:
    """The commonest difference of successive frames of one track (the least of equally common ones).

    Where none is clearly the commonest, since times are those of a clock that is not quite even: the median of those
    that lie around the difference with most others near it. ``None`` where no track has two frames.
    """
    order = np.lexsort([rows.frames, rows.tracks])
    steps = np.diff(rows.frames[order])[np.diff(rows.tracks[order]) == 0]
    steps = steps[steps > 0].round(6)
    if not steps.size:
        return None
    values, counts = np.unique(steps, return_counts=True)
    if counts.max() >= _CLEAR * len(steps):
        return float(values[counts.argmax()])
    steps.sort()
    from_ = np.searchsorted(steps, (1 - _ALIKE) * values, "left")
    to = np.searchsorted(steps, (1 + _ALIKE) * values, "right")
    most = int((to - from_).argmax())
    return float(np.median(steps[from_[most] : to[most]]))
