"""The raster of frames on which a file is annotated: every sixth, every tenth, every one."""

from __future__ import annotations

import numpy as np

from surveillance_domain.trajectories.rows import Rows

__all__ = ["usual_step"]


def usual_step(rows: Rows) -> float | None:
    """The commonest difference of successive frames of one track (the least of equally common ones).

    ``None`` where no track has two frames.
    """
    order = np.lexsort([rows.frames, rows.tracks])
    steps = np.diff(rows.frames[order])[np.diff(rows.tracks[order]) == 0]
    steps = steps[steps > 0].round(6)
    if not steps.size:
        return None
    values, counts = np.unique(steps, return_counts=True)
    return float(values[counts.argmax()])
