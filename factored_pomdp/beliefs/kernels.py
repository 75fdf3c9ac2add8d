"""The compiled loops: apply a sparse operator to many columns at once, condition many columns at once, add them up.

Belief arrays are (states, members): the members of a stack lie next to each other in memory, so that every stored entry
of an operator is read once for many members. Compiled by numba; single-threaded (threads cost more than they bring
where another process holds a core).
"""

from __future__ import annotations

from functools import cache
from typing import Any, no_type_check

import numpy as np
from numba import njit

from factored_pomdp.beliefs.operator import Operator
from factored_pomdp.beliefs.vectors import Tile, product_rows, product_sums, tiles, weighted_rows

__all__ = ["apply_operator", "noisy_or_columns", "reweigh", "row_sums"]


def apply_operator(operator: Operator, table: np.ndarray, at: int, result: np.ndarray, to: int, tile: Tile) -> None:
    """``result = operator @ table`` for the columns of a tile.

    Parameters
    ----------
    table, result : (states in, width), (states out, width) float, C-contiguous
    at, to : int
        The first of the columns, there and here.
    """
    apply = _apply_kernel(tile.shape)
    apply(operator.indptr, operator.indices, operator.data, table, at, result, to, tile.columns)


@cache
def _apply_kernel(shape: int) -> Any:
    """The loop over an operator's rows, compiled for a shape of tile when it is first needed."""

    @njit(cache=True, nogil=True)
    @no_type_check
    def apply_rows(
        indptr: Any, indices: Any, data: Any, table: Any, at: int, result: Any, to: int, columns: int
    ) -> None:
        for row in range(result.shape[0]):
            here = row * result.shape[1] + to
            weighted_rows(data, indices, indptr[row], indptr[row + 1], table, at, result, here, columns, shape)

    return apply_rows


def reweigh(predicted: np.ndarray, context: np.ndarray, likelihood: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """``predicted · likelihood[context]`` normalised member by member, and the members for which that is impossible.

    Columns whose sum is zero are left at zero.

    Parameters
    ----------
    predicted : (states, members) float
    context : (states,) int
    likelihood : (rows, members) float
    """
    arrays = [np.ascontiguousarray(array) for array in (predicted, context, likelihood)]
    result, sums, scaled = np.empty(predicted.shape), np.empty(predicted.shape[1]), np.empty(likelihood.shape)
    impossible = 0
    for tile in tiles(predicted.shape[1]):
        impossible += _reweigh_kernel(tile.shape)(*arrays, scaled, result, sums, tile.first, tile.columns)
    return result, np.flatnonzero(~(sums > 0)) if impossible else _NONE


_NONE = np.zeros(0, dtype=np.int64)


@cache
def _reweigh_kernel(shape: int) -> Any:
    """Compiled for a shape of tile when it is first needed."""

    @njit(cache=True, nogil=True)
    @no_type_check
    def reweigh_columns(
        predicted: Any,
        context: Any,
        likelihood: Any,
        scaled: Any,
        result: Any,
        sums: Any,
        first: int,
        columns: int,
    ) -> int:
        product_sums(predicted, context, likelihood, sums, first, columns, shape)
        impossible = 0
        for member in range(first, first + columns):
            possible = sums[member] > 0.0
            scale = 1.0 / sums[member] if possible else 0.0
            impossible += not possible
            for row in range(likelihood.shape[0]):
                scaled[row, member] = likelihood[row, member] * scale
        product_rows(predicted, context, scaled, result, first, columns, shape)
        return impossible

    return reweigh_columns


@njit(cache=True, nogil=True)
@no_type_check
def row_sums(table: Any, sums: Any) -> None:
    """Sets ``sums[i]`` to ``Σ_j table[i, j]``, four partial sums at a time."""
    rows, columns = table.shape
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


@njit(cache=True, nogil=True)
@no_type_check
def noisy_or_columns(
    activation: Any, chosen: Any, emission_of: Any, indptr: Any, rows: Any, data: Any, off: int, seen: Any, result: Any
) -> None:
    """P(seen value | context) for each member, from a noisy-or whose causes are all fixed.

    Parameters
    ----------
    activation : (causes' values, contexts) float
    chosen : (causes,) int
        Row of each cause's value; negative: that cause is absent.
    emission_of : (causes,) int
        Which emission table each cause uses.
    indptr : (tables, child values + 1) int
        Column starts, in ``rows`` and ``data``, of each emission table.
    off : int
        The child's silent value.
    seen : (members,) int
        The child's value for each member; negative: not looked at (likelihood one).
    result : (contexts, members) float
        Where it goes.
    """
    causes, contexts = len(chosen), activation.shape[1]
    acting = np.empty((causes, contexts))
    silent = np.empty((contexts,))
    for row in range(contexts):
        silent[row] = 1.0
    for cause in range(causes):
        for row in range(contexts):
            active = activation[chosen[cause], row] if chosen[cause] >= 0 else 0.0
            acting[cause, row] = silent[row] * active
            silent[row] *= 1.0 - active
    members = len(seen)
    unseen, quiet = np.zeros(members), np.zeros(members)
    for member in range(members):
        unseen[member] = 1.0 if seen[member] < 0 else 0.0
        quiet[member] = 1.0 if seen[member] == off else 0.0
    for row in range(contexts):
        for member in range(members):
            result[row, member] = unseen[member] + quiet[member] * silent[row]
    for member in range(members):
        value = seen[member]
        if value < 0 or value == off:
            continue
        for cause in range(causes):
            table = emission_of[cause]
            for entry in range(indptr[table, value], indptr[table, value + 1]):
                result[rows[entry], member] += acting[cause, rows[entry]] * data[entry]
