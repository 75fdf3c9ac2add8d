"""The compiled loops: apply a sparse operator to many columns at once, condition many columns at once, add them up.

Belief arrays are (states, members): the members of a stack lie next to each other in memory, so that every stored entry
of an operator is read once for many members. Compiled by numba; single-threaded (threads cost more than they bring
where another process holds a core).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, no_type_check

import numpy as np
from numba import njit

from factored_pomdp.beliefs.vectors import LANES, weighted_rows

if TYPE_CHECKING:
    from factored_pomdp.beliefs.prediction import Operator

__all__ = ["apply_operator", "noisy_or_columns", "reweigh", "row_sums"]


def apply_operator(
    operator: Operator, table: np.ndarray, table_at: int, result: np.ndarray, result_at: int, columns: int
) -> None:
    """``result = operator @ table`` for some columns of both; at most `MOST_COLUMNS` of them.

    Parameters
    ----------
    table, result : (states in, width), (states out, width) float, C-contiguous
    table_at, result_at : int
        The first of the columns, there and here.
    """
    vectors = -(-columns // LANES) if columns >= LANES else -columns
    rows = _rows_kernel(vectors)
    rows(operator.indptr, operator.indices, operator.data, table, table_at, result, result_at, columns)


@cache
def _rows_kernel(vectors: int) -> Any:
    """The loop over an operator's rows, compiled for a number of vectors when it is first needed."""

    @njit(cache=True, nogil=True)
    @no_type_check
    def apply_rows(
        indptr: Any, indices: Any, data: Any, table: Any, table_at: int, result: Any, result_at: int, columns: int
    ) -> None:
        at = result_at
        for row in range(result.shape[0]):
            weighted_rows(data, indices, indptr[row], indptr[row + 1], table, table_at, result, at, columns, vectors)
            at += result.shape[1]

    return apply_rows


@njit(cache=True, nogil=True)
@no_type_check
def row_sums(table: Any) -> Any:
    """``Σ_j table[i, j]``, four partial sums at a time."""
    rows, columns = table.shape
    sums = np.empty(rows)
    for row in range(rows):
        first, second, third, fourth = 0.0, 0.0, 0.0, 0.0
        column = 0
        while column + 4 <= columns:
            first += table[row, column]
            second += table[row, column + 1]
            third += table[row, column + 2]
            fourth += table[row, column + 3]
            column += 4
        while column < columns:
            first += table[row, column]
            column += 1
        sums[row] = (first + second) + (third + fourth)
    return sums


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
