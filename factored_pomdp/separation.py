"""Whether a table falls apart numerically: a sum over groups of variables, or a product over them."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any

import numpy as np

from factored_pomdp.factors import DenseFactor, Factor
from factored_pomdp.factors.base import union
from factored_pomdp.variables import Variable, count

__all__ = ["Tied", "added_up", "additive_parts", "multiplicative_parts"]

_SAME = 1e-12
_MOST_GROUPS = 6
_MOST_ENTRIES = 20_000_000

Group = tuple[Variable, ...]

Tied = tuple[str, Factor, frozenset[int]]
"""Name of a reward, its table, and the numbers of the blocks that it ties together."""


def added_up(tied: Sequence[Tied]) -> list[Tied]:
    """Rewards that have two blocks in common as one reward: what they say of these blocks may cancel.

    Those whose sum is too large to look at stay as they are.
    """
    sums: list[Tied] = []
    for names, table, blocks in tied:
        for other in [one for one in sums if len(one[2] & blocks) > 1]:
            scope = union(other[1].scope, table.scope)
            if count(scope) <= _MOST_ENTRIES:
                sums.remove(other)
                names, blocks = f"{other[0]} + {names}", blocks | other[2]
                shape = [variable.size for variable in scope]
                table = DenseFactor(scope, np.broadcast_to(other[1].array_over(scope) + table.array_over(scope), shape))
        sums.append((names, table, blocks))
    return sums


def additive_parts(factor: Factor, groups: Sequence[Group]) -> list[tuple[list[int], Factor]]:
    """Write a reward as a sum of parts, each over as few groups as it can be.

    Parameters
    ----------
    groups : sequence of tuples of Variable
        Disjoint parts of the scope; the rest of the scope is context and stays in every part.

    Returns
    -------
    list of (numbers of the groups that interact, factor over them and the context)
        One part with all groups where the table is too large to look at.
    """
    whole = [(list(range(len(groups))), factor)]
    if len(groups) < 2 or factor.size > _MOST_ENTRIES:
        return whole
    context = tuple(variable for variable in factor.scope if not any(variable in group for group in groups))
    shape = (count(context), *(count(group) for group in groups))
    array = factor.array_over([*context, *itertools.chain(*groups)]).reshape(shape)
    scale = max(1.0, float(np.abs(array).max()))
    tied = {number: {number} for number in range(len(groups))}
    for one, other in itertools.combinations(range(len(groups)), 2):
        if np.abs(_difference(_difference(array, one + 1), other + 1)).max() > _SAME * scale:
            merged = tied[one] | tied[other]
            for number in merged:
                tied[number] = merged
    components = sorted({tuple(sorted(component)) for component in tied.values()})
    if len(components) == 1:
        return whole
    parts: list[tuple[list[int], Factor]] = []
    for position, component in enumerate(components):
        index: list[Any] = [slice(None)] + [slice(None) if n in component else slice(0, 1) for n in range(len(groups))]
        part = array[tuple(index)]
        if position:
            part = part - array[(slice(None), *[slice(0, 1)] * len(groups))]
        scope = [*context, *itertools.chain(*(groups[number] for number in component))]
        parts.append((list(component), DenseFactor(scope, part.reshape([variable.size for variable in scope]))))
    return parts


def multiplicative_parts(factor: Factor, groups: Sequence[Group]) -> list[tuple[list[int], Factor]]:
    """Write a likelihood as a product of parts over groups, slice by slice of its context.

    A slice ``f(A, B)`` is a product iff ``f · total = (row sum) ⊗ (column sum)``. The finest partition is the common
    refinement of the two-way splits. Groups that split off alone are found first; of the others, if no more than six
    are left, every two-way split is tried.

    Returns
    -------
    as `additive_parts`; the product of the parts is the factor.
    """
    whole = [(list(range(len(groups))), factor)]
    if len(groups) < 2 or factor.size > _MOST_ENTRIES:
        return whole
    context = tuple(variable for variable in factor.scope if not any(variable in group for group in groups))
    shape = (count(context), *(count(group) for group in groups))
    array = factor.array_over([*context, *itertools.chain(*groups)]).reshape(shape)
    left, labels, rest = [], [0] * len(groups), array
    for number in range(len(groups)):
        if _splits(rest, [number]):
            labels[number], rest = number + 1, rest.sum(axis=number + 1, keepdims=True)
        else:
            left.append(number)
    for size in range(2, len(left) // 2 + 1 if len(left) <= _MOST_GROUPS else 0):
        for side in itertools.combinations(left, size):
            if _splits(rest, list(side)):
                labels = [2 * label + (number in side) for number, label in enumerate(labels)]
    if len(set(labels)) == 1:
        return whole
    parts: list[tuple[list[int], Factor]] = []
    total = array.sum(axis=tuple(range(1, array.ndim)), keepdims=True)
    scale = np.divide(1.0, total, out=np.zeros_like(total), where=total > 0)
    for label in sorted(set(labels)):
        component = [number for number, other in enumerate(labels) if other == label]
        gone = tuple(number + 1 for number in range(len(groups)) if number not in component)
        scope = [*context, *itertools.chain(*(groups[number] for number in component))]
        sums = array.sum(axis=gone, keepdims=True) * (scale if parts else 1.0)
        parts.append((component, DenseFactor(scope, sums.reshape([variable.size for variable in scope]))))
    return parts


def _difference(array: np.ndarray, axis: int) -> np.ndarray:
    return array - np.take(array, [0], axis=axis)


def _splits(array: np.ndarray, side: list[int]) -> bool:
    inside = tuple(number + 1 for number in side)
    outside = tuple(number for number in range(1, array.ndim) if number not in inside)
    total = array.sum(axis=(*inside, *outside), keepdims=True)
    product = array.sum(axis=inside, keepdims=True) * array.sum(axis=outside, keepdims=True)
    return bool((np.abs(array * total - product) <= _SAME * total**2).all())
