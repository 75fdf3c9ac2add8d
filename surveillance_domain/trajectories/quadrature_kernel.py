"""The compiled inner loop of `surveillance_domain.trajectories.open_floor`."""

from __future__ import annotations

import math
from typing import Any, no_type_check

from numba import njit

__all__ = ["add_overlaps"]


@no_type_check  # numba compiles the plain function, not one that checks its types
@njit(cache=True, nogil=True)
def add_overlaps(
    heading: Any,
    length: Any,
    which: Any,
    low: Any,
    angles: Any,
    weights: Any,
    paces: Any,
    pace_weights: Any,
    found: Any,
) -> None:
    """Add to ``found[i]`` the mean shares that a unit square, moved from the origin, has of four cells.

    The cell ``low[i]``, the one to its right, the one above it, and the one above that to the right. The mean is over
    directions ``heading[i] + angles`` and lengths ``length[i] + paces``, weighted; only where ``which[i]``.
    """
    for pair in range(len(heading)):
        if not which[pair]:
            continue
        for turn in range(len(angles)):
            across = math.cos(heading[pair] + angles[turn])
            up = math.sin(heading[pair] + angles[turn])
            for pace in range(len(paces)):
                far = max(length[pair] + paces[pace], 0.0)
                x, y = across * far - low[pair, 0], up * far - low[pair, 1]
                if -1.0 < x < 2.0 and -1.0 < y < 2.0:
                    weight = weights[turn] * pace_weights[pace]
                    left, right = weight * max(1.0 - abs(x), 0.0), weight * max(1.0 - abs(x - 1.0), 0.0)
                    bottom, top = max(1.0 - abs(y), 0.0), max(1.0 - abs(y - 1.0), 0.0)
                    found[pair, 0] += left * bottom
                    found[pair, 1] += right * bottom
                    found[pair, 2] += left * top
                    found[pair, 3] += right * top
