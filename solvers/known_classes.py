"""What an agent can always tell: the finest classes of joint states that action and observation keep apart.

All states that the initial belief allows are one class; all states that can follow a class under one action with one
observation belong to one class. Merged until nothing changes. Time: passes times the entries of ``P(s' | s, a)`` times
those of a row of ``P(z | s', a)``; memory: two numbers for each pair of a joint state and an observation.
"""

from __future__ import annotations

from typing import Any, no_type_check

import numpy as np
from jaxtyping import Float, Int

from solvers.compilation import compiled, part

__all__ = ["known_classes"]

_MOST_PAIRS = 200_000_000


def known_classes(
    transition: list[Any], observation: list[Any], initial: Float[np.ndarray, " states"]
) -> Int[np.ndarray, " states"]:
    """A number for each joint state, equal within a class; states that are never reached are alone.

    Parameters
    ----------
    transition, observation : lists of CSR arrays
        ``P(s' | s)`` and ``P(z | s')`` for each action.
    """
    states, columns = observation[0].shape
    parent = np.arange(states)
    parent[initial > 0] = np.flatnonzero(initial > 0)[0]
    reached = initial > 0
    if states * columns > _MOST_PAIRS:
        parent[_all_reached(transition, reached)] = np.flatnonzero(initial > 0)[0]
        return parent
    holder = np.zeros(states * columns, dtype=np.int32)
    stamp = np.full(states * columns, -1, dtype=np.int32)
    number, changed = 0, True
    while changed:
        changed = False
        for moves, views in zip(transition, observation, strict=True):
            rows = (*_rows(moves), *_rows(views))
            changed |= _merge(*rows, columns, parent, reached, holder, stamp, number)
            number += 1
    while (parent != parent[parent]).any():
        parent = parent[parent]
    return parent


def _rows(matrix: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compressed rows with one kind of whole number, for which the loop is compiled."""
    return matrix.indptr.astype(np.int64, copy=False), matrix.indices.astype(np.int64, copy=False), matrix.data


def _all_reached(transition: list[Any], reached: np.ndarray) -> np.ndarray:
    found = reached
    while True:
        after = found.copy()
        for moves in transition:
            after |= (found.astype(float) @ moves) > 0
        if (after == found).all():
            return found
        found = after


@part
@no_type_check
def _root(parent, state):
    while parent[state] != state:
        parent[state] = parent[parent[state]]
        state = parent[state]
    return state


@compiled
@no_type_check
def _merge(
    move_start, move_state, move_chance, seen_start, seen_column, seen_chance,
    columns, parent, reached, holder, stamp, number,
):  # fmt: skip
    changed = False
    for state in range(reached.shape[0]):
        if not reached[state]:
            continue
        own = _root(parent, state)
        for j in range(move_start[state], move_start[state + 1]):
            after = move_state[j]
            if move_chance[j] <= 0:
                continue
            if not reached[after]:
                reached[after] = True
                changed = True
            for k in range(seen_start[after], seen_start[after + 1]):
                if seen_chance[k] <= 0:
                    continue
                key = own * columns + seen_column[k]
                if stamp[key] != number:
                    stamp[key] = number
                    holder[key] = after
                    continue
                one, other = _root(parent, np.int64(holder[key])), _root(parent, after)
                if one < other:
                    parent[other] = one
                elif other < one:
                    parent[one] = other
                changed = changed or one != other
    return changed
