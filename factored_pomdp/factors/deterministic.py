"""A factor that says: this variable is a function of those."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from factored_pomdp.factors.base import Factor, address
from factored_pomdp.factors.dense import DenseFactor
from factored_pomdp.factors.sparse import SparseFactor, unflatten
from factored_pomdp.variables import Value, Variable, count

__all__ = ["DeterministicFactor"]


class DeterministicFactor(Factor):
    """``[child = f(parents)]``, the Kronecker delta of eq:4; one index is held for each assignment of the parents.

    Parameters
    ----------
    parents : iterable of Variable
    child : Variable
    indexes : array_like of int
        Shape: the parents' sizes; position of the child's value.
    """

    def __init__(self, parents: Iterable[Variable], child: Variable, indexes: Any) -> None:
        self.parents, self.child = tuple(parents), child
        self.scope = (*self.parents, child)
        self.indexes = np.asarray(indexes, dtype=np.int64).reshape([parent.size for parent in self.parents])

    @property
    def storage(self) -> tuple[int, ...]:
        return address(self.indexes)

    @property
    def stored(self) -> int:
        return int(self.indexes.size)

    def sparse(self) -> SparseFactor:
        keys = np.arange(count(self.parents))
        coordinates = np.concatenate([unflatten(keys, self.parents), self.indexes.reshape(-1, 1)], axis=1)
        return SparseFactor(self.scope, coordinates, np.ones(len(keys)))

    def dense(self) -> DenseFactor:
        return self.sparse().dense()

    def renamed(self, names: Mapping[str, str]) -> DeterministicFactor:
        if not any(names.get(name, name) != name for name in self.names):
            return self
        parents = [parent.renamed(names.get(parent.name, parent.name)) for parent in self.parents]
        return DeterministicFactor(
            parents, self.child.renamed(names.get(self.child.name, self.child.name)), self.indexes
        )

    def condition(self, assignment: Mapping[str, Value]) -> Factor:
        if self.child.name in assignment:
            return self.sparse().condition(assignment)
        index = tuple(v.index(assignment[v.name]) if v.name in assignment else slice(None) for v in self.parents)
        parents = [parent for parent in self.parents if parent.name not in assignment]
        return DeterministicFactor(parents, self.child, self.indexes[index])

    def result(self, assignment: Mapping[str, Value]) -> Value:
        """The child's value at one assignment of all parents."""
        index = tuple(parent.index(assignment[parent.name]) for parent in self.parents)
        return self.child.values[int(self.indexes[index])]
