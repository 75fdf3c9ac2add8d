"""Which vectors are nowhere above another one; a compiled loop."""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Float, Int

from solvers.compilation import compiled

__all__ = ["undominated_rows"]


def undominated_rows(
    vectors: Float[np.ndarray, "k states"], order: Int[np.ndarray, " k"], slack: float
) -> Bool[np.ndarray, " k"]:
    """Go through the vectors in an order and keep those that no kept one reaches everywhere (up to slack)."""
    kept = np.empty(len(vectors), np.int64)
    keep = np.zeros(len(vectors), dtype=bool)
    keep[kept[: _undominated_rows(vectors, order, slack, kept)]] = True
    return keep


@compiled
@no_type_check
def _undominated_rows(vectors, order, slack, kept):
    number = 0
    for i in range(order.shape[0]):
        position = order[i]
        is_below = False
        for place in range(number):
            above = kept[place]
            is_below = True
            for state in range(vectors.shape[1]):
                if vectors[above, state] < vectors[position, state] - slack:
                    is_below = False
                    break
            if is_below:
                # What covers one vector often covers the next.
                kept[place] = kept[0]
                kept[0] = above
                break
        if not is_below:
            kept[number] = position
            number += 1
    return number
