"""Points that cannot lie on the floor: on the horizon of a homography or beyond it, or farther than all places."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.conventions import MOST_M, Conventions, third_coordinate
from surveillance_domain.trajectories.rows import Rows

__all__ = ["beyond_earth", "beyond_horizon"]


def beyond_horizon(rows: Rows, conventions: Conventions) -> Fault | None:
    """What is wrong where points lie on the horizon, or on both sides of it; ``None`` where all lie on one side.

    The side is the sign of the third homogeneous coordinate. A floor is seen on one side of its horizon only.
    """
    if conventions.homography is None:
        return None
    side = np.sign(third_coordinate(rows.points, conventions.homography))
    usual = 1.0 if (side > 0).sum() >= (side < 0).sum() else -1.0
    beyond = side != usual
    if not beyond.any():
        return None
    return Fault(
        conventions.homography_from,
        f"a matrix that has {int(beyond.sum()):,} of {len(side):,} points on its horizon or beyond it, the first on "
        f"line {int(rows.lines[beyond].min())}",
        "the matrix from the points of this file to metres on the floor (is it another recording's, or the inverse?); "
        "where it is, no rows of points that cannot lie on the floor",
    )


def beyond_earth(rows: Rows, points: Float[np.ndarray, "rows 2"]) -> Fault | None:
    """The first point, in metres, that is too far away to be reckoned with; ``None`` where there is none."""
    beyond = np.flatnonzero(~(np.abs(points) <= MOST_M).all(axis=1))
    if not beyond.size:
        return None
    at = beyond[rows.lines[beyond].argmin()]
    x, y = points[at].tolist()
    who = f"id {rows.names[rows.tracks[at]]} at ({x:.6g}, {y:.6g}) m"
    return Fault(f"line {rows.lines[at]}", who, "metres on the floor")
