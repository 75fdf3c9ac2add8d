"""The two compiled loops: apply a sparse operator to many columns at once, and condition many columns at once.

Belief arrays are (states, members): the members of a stack lie next to each other in memory, so that every stored entry
of an operator is read once for many members. Compiled by numba; single-threaded (threads cost more than they bring
where another process holds a core).
"""

from __future__ import annotations

from typing import Any, no_type_check

import numpy as np
from numba import njit

__all__ = ["apply_operator", "noisy_or_columns", "reweigh"]


@njit(cache=True, nogil=True)
@no_type_check
def apply_operator(indptr: Any, indices: Any, data: Any, column: Any, result: Any) -> None:
    """``result = operator @ column`` for a CSR operator (states out, states in) and columns (states in, members).

    Four entries at a time: the result's row is then loaded and stored a quarter as often.
    """
    members = column.shape[1]
    for row in range(result.shape[0]):
        out = result[row]
        for member in range(members):
            out[member] = 0.0
        entry, end = indptr[row], indptr[row + 1]
        while entry + 4 <= end:
            w0, w1, w2, w3 = data[entry], data[entry + 1], data[entry + 2], data[entry + 3]
            c0, c1 = column[indices[entry]], column[indices[entry + 1]]
            c2, c3 = column[indices[entry + 2]], column[indices[entry + 3]]
            for member in range(members):
                out[member] += w0 * c0[member] + w1 * c1[member] + w2 * c2[member] + w3 * c3[member]
            entry += 4
        while entry < end:
            weight, source = data[entry], column[indices[entry]]
            for member in range(members):
                out[member] += weight * source[member]
            entry += 1


@njit(cache=True, nogil=True)
@no_type_check
def reweigh(predicted: Any, context: Any, likelihood: Any, result: Any, sums: Any) -> None:
    """``result ∝ predicted · likelihood[context]`` member by member; ``sums`` receives the normalising constants.

    Columns whose sum is zero are left at zero.
    """
    states, members = predicted.shape
    for member in range(members):
        sums[member] = 0.0
    for state in range(states):
        before, weight, after = predicted[state], likelihood[context[state]], result[state]
        for member in range(members):
            mass = before[member] * weight[member]
            after[member] = mass
            sums[member] += mass
    scale = sums.copy()
    for member in range(members):
        scale[member] = 1.0 / sums[member] if sums[member] > 0.0 else 0.0
    for state in range(states):
        after = result[state]
        for member in range(members):
            after[member] *= scale[member]


@njit(cache=True, nogil=True)
@no_type_check
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
