"""The sum of several rewards: one table where that is small, else a base and a sparse table of differences from it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.factors.base import union
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.files.defaults import Piece, cheapest_base, looked_up
from factored_pomdp.files.layers import MOST_ENTRIES
from factored_pomdp.variables import Variable, count

__all__ = ["summed", "with_base"]

_MOST_PLACES = 5_000_000
"""Places of a sum that is laid out in full."""


def summed(rewards: Sequence[Factor]) -> tuple[Factor, ...] | None:
    """One or two factors with the same sum; ``None`` where they would hold more than `MOST_ENTRIES`.

    Of two, the first is the base, and the second, a sparse one, reads all of its variables.
    """
    scope = union(*(reward.scope for reward in rewards))
    if count(scope) <= _MOST_PLACES:
        total = np.zeros([variable.size for variable in scope])
        for reward in rewards:
            total += reward.array_over(scope)
        return (DenseFactor(scope, total),)
    masks = [sum(1 << scope.index(variable) for variable in reward.scope) for reward in rewards]
    tables = [reward.sparse() for reward in rewards]
    pieces = [Piece(mask, table.stored, table.stored) for mask, table in zip(masks, tables, strict=True)]
    chosen, entries = cheapest_base(pieces, [variable.size for variable in scope])
    if entries > MOST_ENTRIES:
        return None
    within = [table for mask, table in zip(masks, tables, strict=True) if not mask & ~chosen]
    others = [table for mask, table in zip(masks, tables, strict=True) if mask & ~chosen]
    axes = tuple(variable for position, variable in enumerate(scope) if chosen >> position & 1)
    base = _total(within, axes)
    return (base, _total(others, union(axes, *(table.scope for table in others)))) if others else (base,)


def with_base(base: Factor, differences: SparseFactor) -> SparseFactor:
    """The differences, each with the base's number added to it."""
    table = base.sparse()
    keys = table.flat(table.scope)
    order = np.argsort(keys)
    numbers = looked_up(keys[order], table.numbers[order], differences.flat(table.scope))
    return SparseFactor(differences.scope, differences.coordinates, differences.numbers + numbers)


def _total(tables: Sequence[SparseFactor], scope: tuple[Variable, ...]) -> SparseFactor:
    """The sum over a scope that holds those of all the tables."""
    keys, numbers = [np.zeros(0, dtype=np.int64)], [np.zeros(0)]
    for table in tables:
        missing = [variable for variable in scope if variable not in table.scope]
        everywhere = DenseFactor(missing, np.ones([variable.size for variable in missing]))
        spread = table.join(everywhere)
        keys.append(spread.flat(scope))
        numbers.append(spread.numbers)
    places, positions = np.unique(np.concatenate(keys), return_inverse=True)
    sums = np.bincount(positions.ravel(), weights=np.concatenate(numbers), minlength=len(places))
    return SparseFactor(scope, unflatten(places[sums != 0], scope), sums[sums != 0])
