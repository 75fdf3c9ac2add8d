"""The two compiled loops: apply a sparse operator to many columns at once, and condition many columns at once.

Belief arrays are (states, members): the members of a stack lie next to each other in memory, so that every stored entry
of an operator is read once for many members. Compiled by numba; single-threaded (threads cost more than they bring
where another process holds a core).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit

__all__ = ["apply_operator", "noisy_or_columns", "reweigh"]

_CHUNK = 64


@njit(cache=True, nogil=True)
def apply_operator(indptr: Any, indices: Any, data: Any, column: Any, result: Any) -> None:
    """``result = operator @ column`` for a CSR operator (states out, states in) and columns (states in, members)."""
    members = column.shape[1]
    for start in range(0, members, _CHUNK):
        end = min(start + _CHUNK, members)
        for row in range(result.shape[0]):
            for member in range(start, end):
                result[row, member] = 0.0
            for entry in range(indptr[row], indptr[row + 1]):
                weight = data[entry]
                source = indices[entry]
                for member in range(start, end):
                    result[row, member] += weight * column[source, member]


@njit(cache=True, nogil=True)
def reweigh(predicted: Any, context: Any, likelihood: Any, result: Any, sums: Any) -> None:
    """``result ∝ predicted · likelihood[context]`` member by member; ``sums`` receives the normalising constants.

    Columns whose sum is zero are left at zero.
    """
    states, members = predicted.shape
    for member in range(members):
        sums[member] = 0.0
    for state in range(states):
        row = context[state]
        for member in range(members):
            mass = predicted[state, member] * likelihood[row, member]
            result[state, member] = mass
            sums[member] += mass
    scale = sums.copy()
    for member in range(members):
        scale[member] = 1.0 / sums[member] if sums[member] > 0.0 else 0.0
    for state in range(states):
        for member in range(members):
            result[state, member] *= scale[member]


@njit(cache=True, nogil=True)
def noisy_or_columns(activation: Any, emission_of: Any, indptr: Any, rows: Any, data: Any, off: int, seen: Any) -> Any:
    """P(seen value | context) for each member, from a noisy-or whose causes are all fixed.

    Parameters
    ----------
    activation : (causes, contexts) float
    emission_of : (causes,) int
        Which emission table each cause uses.
    indptr : (tables, child values + 1) int
        Column starts, in ``rows`` and ``data``, of each emission table.
    off : int
        The child's silent value.
    seen : (members,) int
        The child's value for each member; negative: not looked at (likelihood one).
    """
    causes, contexts = activation.shape
    acting = np.empty((causes, contexts))
    silent = np.empty((contexts,))
    for row in range(contexts):
        silent[row] = 1.0
    for cause in range(causes):
        for row in range(contexts):
            acting[cause, row] = silent[row] * activation[cause, row]
            silent[row] *= 1.0 - activation[cause, row]
    members = len(seen)
    likelihood = np.empty((contexts, members))
    for row in range(contexts):
        for member in range(members):
            if seen[member] < 0:
                likelihood[row, member] = 1.0
            elif seen[member] == off:
                likelihood[row, member] = silent[row]
            else:
                likelihood[row, member] = 0.0
    for member in range(members):
        value = seen[member]
        if value < 0 or value == off:
            continue
        for cause in range(causes):
            table = emission_of[cause]
            for entry in range(indptr[table, value], indptr[table, value + 1]):
                likelihood[rows[entry], member] += acting[cause, rows[entry]] * data[entry]
    return likelihood
