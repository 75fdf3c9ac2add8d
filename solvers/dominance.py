"""Which vectors are nowhere above another one; a compiled loop."""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from numba import njit

__all__ = ["undominated_rows"]


@njit(cache=True)
@no_type_check
def undominated_rows(vectors, order, slack):
    """Go through the vectors in an order and keep those that no kept one reaches everywhere (up to slack)."""
    keep = np.zeros(vectors.shape[0], np.bool_)
    kept = np.empty(vectors.shape[0], np.int64)
    number = 0
    for position in order:
        is_below = False
        for place in range(number):
            above = vectors[kept[place]]
            is_below = True
            for state in range(vectors.shape[1]):
                if above[state] < vectors[position, state] - slack:
                    is_below = False
                    break
            if is_below:
                # What covers one vector often covers the next.
                first = kept[place]
                kept[place] = kept[0]
                kept[0] = first
                break
        if not is_below:
            keep[position] = True
            kept[number] = position
            number += 1
    return keep
