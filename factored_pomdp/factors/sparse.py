"""A factor as a list of its entries that are not zero."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors.base import MAX_ENTRIES, Factor, address, union
from factored_pomdp.factors.dense import DenseFactor
from factored_pomdp.variables import Value, Variable, count

__all__ = ["SparseFactor"]


class SparseFactor(Factor):
    """Coordinates and numbers; every assignment that is not listed has the number 0.

    Parameters
    ----------
    scope : iterable of Variable
    coordinates : (entries, variables) int
        Positions of the values, one column a variable. No row twice.
    numbers : (entries,) float
    """

    def __init__(self, scope: Iterable[Variable], coordinates: Any, numbers: Any) -> None:
        self.scope = tuple(scope)
        self.numbers = np.asarray(numbers, dtype=float)
        self.coordinates = np.asarray(coordinates).reshape(len(self.numbers), len(self.scope))

    @property
    def storage(self) -> tuple[int, ...]:
        return (*address(self.coordinates), *address(self.numbers))

    @property
    def stored(self) -> int:
        return len(self.numbers)

    def sparse(self) -> SparseFactor:
        return self

    def dense(self) -> DenseFactor:
        self.refuse_if_large(self.scope)
        array = np.zeros([variable.size for variable in self.scope])
        array[tuple(self.coordinates.T)] = self.numbers if self.scope else self.numbers.sum()
        return DenseFactor(self.scope, array)

    def renamed(self, names: Mapping[str, str]) -> SparseFactor:
        if not any(names.get(name, name) != name for name in self.names):
            return self
        return SparseFactor([v.renamed(names.get(v.name, v.name)) for v in self.scope], self.coordinates, self.numbers)

    def condition(self, assignment: Mapping[str, Value]) -> SparseFactor:
        kept = np.ones(len(self.numbers), dtype=bool)
        for axis, variable in enumerate(self.scope):
            if variable.name in assignment:
                kept &= self.coordinates[:, axis] == variable.index(assignment[variable.name])
        axes = [axis for axis, variable in enumerate(self.scope) if variable.name not in assignment]
        return SparseFactor([self.scope[a] for a in axes], self.coordinates[kept][:, axes], self.numbers[kept])

    def flat(self, variables: Iterable[Variable]) -> np.ndarray:
        """Row-major position of every entry within the table over some variables of the scope."""
        listed = tuple(variables)
        if count(listed) > np.iinfo(np.int64).max:
            raise TooLarge(f"positions over {', '.join(v.name for v in listed)} pass 64 bits: {count(listed):.3g}")
        flat = np.zeros(len(self.numbers), dtype=np.int64)
        for variable in listed:
            flat = flat * variable.size + self.coordinates[:, self.scope.index(variable)]
        return flat

    def marginalise(self, *variables: Variable) -> SparseFactor:
        gone = {self.variable(variable.name) for variable in variables}
        scope = tuple(variable for variable in self.scope if variable not in gone)
        keys, positions = np.unique(self.flat(scope), return_inverse=True)
        sums = np.bincount(positions.ravel(), weights=self.numbers, minlength=len(keys))
        return SparseFactor(scope, unflatten(keys, scope), sums)

    def join(self, other: Factor) -> SparseFactor:
        """Product with any factor: entries that agree on the shared variables are paired."""
        if isinstance(other, DenseFactor) and set(other.scope) <= set(self.scope):
            columns = tuple(self.coordinates[:, self.scope.index(variable)] for variable in other.scope)
            numbers = self.numbers * other.array[columns]
            kept = numbers != 0
            if 2 * np.count_nonzero(kept) > len(numbers):
                return SparseFactor(self.scope, self.coordinates, numbers)
            return SparseFactor(self.scope, self.coordinates[kept], numbers[kept])
        right = other.sparse()
        shared = tuple(variable for variable in self.scope if variable in right.scope)
        scope = union(self.scope, right.scope)
        left_keys, right_keys = self.flat(shared), right.flat(shared)
        order = np.argsort(right_keys, kind="stable")
        first = np.searchsorted(right_keys[order], left_keys, side="left")
        matches = np.searchsorted(right_keys[order], left_keys, side="right") - first
        total = int(matches.sum())
        if total > MAX_ENTRIES:
            raise TooLarge(f"the product over {[v.name for v in scope]} would hold {total:,} entries")
        left = np.repeat(np.arange(len(left_keys)), matches)
        within = np.arange(total) - np.repeat(np.cumsum(matches) - matches, matches)
        rows = order[np.repeat(first, matches) + within]
        extra = [axis for axis, variable in enumerate(right.scope) if variable not in shared]
        coordinates = np.concatenate([self.coordinates[left], right.coordinates[rows][:, extra]], axis=1)
        return SparseFactor(scope, coordinates, self.numbers[left] * right.numbers[rows])


def unflatten(keys: np.ndarray, scope: tuple[Variable, ...]) -> np.ndarray:
    """Coordinates of row-major positions; inverse of `SparseFactor.flat`."""
    if not scope:
        return np.zeros((len(keys), 0), dtype=np.int64)
    return np.stack(np.unravel_index(keys, [variable.size for variable in scope]), axis=1)
