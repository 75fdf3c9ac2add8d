"""A factor as a full table."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from factored_pomdp.factors.base import Factor, address, union
from factored_pomdp.variables import Value, Variable

__all__ = ["DenseFactor", "constant"]


class DenseFactor(Factor):
    """A table with one axis a variable.

    Parameters
    ----------
    scope : iterable of Variable
        In the order of the axes.
    array : array_like
        Shape: the variables' sizes.
    """

    def __init__(self, scope: Iterable[Variable], array: Any) -> None:
        self.scope = tuple(scope)
        self.array = np.asarray(array, dtype=float)
        shape = tuple(variable.size for variable in self.scope)
        if self.array.shape != shape:
            raise ValueError(f"array of shape {self.array.shape} for {self.names}, whose sizes are {shape}")

    @property
    def storage(self) -> tuple[int, ...]:
        return address(self.array)

    @property
    def stored(self) -> int:
        return int(self.array.size)

    def dense(self) -> DenseFactor:
        return self

    def sparse(self) -> Any:
        from factored_pomdp.factors.sparse import SparseFactor

        return SparseFactor(self.scope, np.argwhere(self.array), self.array[self.array != 0])

    def renamed(self, names: Mapping[str, str]) -> DenseFactor:
        if not any(names.get(name, name) != name for name in self.names):
            return self
        return DenseFactor([v.renamed(names.get(v.name, v.name)) for v in self.scope], self.array)

    def condition(self, assignment: Mapping[str, Value]) -> DenseFactor:
        index = tuple(v.index(assignment[v.name]) if v.name in assignment else slice(None) for v in self.scope)
        return DenseFactor([v for v in self.scope if v.name not in assignment], self.array[index])

    def multiply(self, other: DenseFactor) -> DenseFactor:
        """Product of two tables, by broadcasting."""
        scope = union(self.scope, other.scope)
        self.refuse_if_large(scope)
        shape = [variable.size for variable in scope]
        return DenseFactor(scope, np.broadcast_to(self.array_over(scope) * other.array_over(scope), shape))

    def marginalise(self, *variables: Variable) -> DenseFactor:
        return DenseFactor(self._without(variables), self.array.sum(axis=self._axes(variables)))

    def maximise(self, *variables: Variable) -> DenseFactor:
        return DenseFactor(self._without(variables), self.array.max(axis=self._axes(variables)))

    def substituted(self, variable: Variable, by: Variable, indexes: np.ndarray) -> DenseFactor:
        axis = self.scope.index(variable)
        if by == variable or by not in self.scope:
            scope = (*self.scope[:axis], by, *self.scope[axis + 1 :])
            return DenseFactor(scope, np.take(self.array, indexes, axis=axis))
        others = [other for other in self.scope if other not in (variable, by)]
        array = self.array_over([variable, by, *others])
        return DenseFactor([by, *others], array[indexes, np.arange(by.size)])

    def _axes(self, variables: Iterable[Variable]) -> tuple[int, ...]:
        return tuple(self.scope.index(self.variable(variable.name)) for variable in variables)

    def _without(self, variables: Iterable[Variable]) -> list[Variable]:
        gone = set(variables)
        return [variable for variable in self.scope if variable not in gone]


def constant(number: float) -> DenseFactor:
    """A factor over nothing."""
    return DenseFactor((), number)
