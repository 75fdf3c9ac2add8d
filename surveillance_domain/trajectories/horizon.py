"""A homography whose horizon runs through the points: it cannot be the one from these points to the floor."""

from __future__ import annotations

import numpy as np

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.conventions import Conventions
from surveillance_domain.trajectories.rows import Rows

__all__ = ["beyond_horizon"]

_ON_IT = 1e-12


def beyond_horizon(rows: Rows, conventions: Conventions) -> Fault | None:
    """What is wrong where points lie on the horizon, or on both sides of it; ``None`` where all lie on one side.

    The side is the sign of the third homogeneous coordinate. A floor is seen on one side of its horizon only.
    """
    if conventions.homography is None:
        return None
    third = np.column_stack([rows.points, np.ones(len(rows.points))]) @ conventions.homography[2]
    side = np.where(np.abs(third) < _ON_IT, 0.0, np.sign(third))
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
