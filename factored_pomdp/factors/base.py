"""What every factor can do: a nonnegative (or, for rewards, any real) function over a scope of variables."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from factored_pomdp.errors import TooLarge, did_you_mean
from factored_pomdp.variables import Value, Variable, count

if TYPE_CHECKING:
    from factored_pomdp.factors.dense import DenseFactor
    from factored_pomdp.factors.sparse import SparseFactor

__all__ = ["MAX_ENTRIES", "Factor", "address", "union"]

MAX_ENTRIES = 50_000_000
"""Entries that a single factor may hold (400 MB of doubles) before an operation refuses to make it."""


class Factor(ABC):
    """A function over ``scope``; one algebra for every representation.

    Factors are immutable. Operations return a factor in whichever representation is smallest to make: products and sums
    of dense factors are dense, those that touch a sparse factor are sparse.
    """

    scope: tuple[Variable, ...]

    @abstractmethod
    def condition(self, assignment: Mapping[str, Value]) -> Factor:
        """The factor at fixed values; names outside of the scope are passed over."""

    @abstractmethod
    def dense(self) -> DenseFactor:
        """The same function as a full table; `TooLarge` beyond `MAX_ENTRIES`."""

    @abstractmethod
    def sparse(self) -> SparseFactor:
        """The same function as a list of its entries that are not zero."""

    @abstractmethod
    def renamed(self, names: Mapping[str, str]) -> Factor:
        """The same function over variables of other names."""

    @property
    @abstractmethod
    def stored(self) -> int:
        """How many numbers this representation holds."""

    @property
    @abstractmethod
    def storage(self) -> tuple[int, ...]:
        """Where the numbers lie, and how: equal for factors that are renamings of one another."""

    def product(self, other: Factor) -> Factor:
        """Pointwise product over the union of the scopes."""
        from factored_pomdp.factors.dense import DenseFactor

        if isinstance(self, DenseFactor) and isinstance(other, DenseFactor):
            return self.multiply(other)
        return self.sparse().join(other)

    def marginalise(self, *variables: Variable) -> Factor:
        """Sum over some variables of the scope."""
        return self.sparse().marginalise(*variables)

    def maximise(self, *variables: Variable) -> Factor:
        """Largest value over some variables of the scope."""
        return self.dense().maximise(*variables)

    def substituted(self, variable: Variable, by: Variable, indexes: np.ndarray) -> Factor:
        """The factor with ``variable`` replaced by a function of ``by``: its value ``k`` stands for ``indexes[k]``."""
        return self.dense().substituted(variable, by, indexes)

    @property
    def size(self) -> int:
        """Number of joint assignments of the scope."""
        return count(self.scope)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the variables in the scope."""
        return tuple(variable.name for variable in self.scope)

    def value(self, assignment: Mapping[str, Value]) -> float:
        """The number at one full assignment of the scope."""
        missing = [name for name in self.names if name not in assignment]
        if missing:
            raise ValueError(f"no value given for {', '.join(missing)}")
        return float(self.condition({name: assignment[name] for name in self.names}).dense().array)

    def variable(self, name: str) -> Variable:
        """The variable of that name in the scope."""
        for variable in self.scope:
            if variable.name == name:
                return variable
        raise ValueError(f"no variable {name!r} in the scope{did_you_mean(name, self.names)}")

    def array_over(self, scope: Iterable[Variable]) -> np.ndarray:
        """The table with its axes in a given order; variables outside of the factor's scope get a broadcast axis."""
        dense = self.dense()
        order = [variable for variable in scope]
        if order == list(dense.scope):
            return dense.array
        present = [variable for variable in order if variable in dense.scope]
        array = np.transpose(dense.array, [dense.scope.index(variable) for variable in present])
        return array.reshape([variable.size if variable in dense.scope else 1 for variable in order])

    def refuse_if_large(self, scope: Iterable[Variable]) -> None:
        """Raise `TooLarge` if a table over ``scope`` would pass `MAX_ENTRIES`."""
        variables = tuple(scope)
        entries = count(variables)
        if entries > MAX_ENTRIES:
            names = " × ".join(f"{variable.name} ({variable.size})" for variable in variables)
            raise TooLarge(f"a full table over {names} would hold {entries:,} numbers, more than {MAX_ENTRIES:,}")

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(self.names)}; {self.stored} stored)"


def address(array: np.ndarray) -> tuple[int, ...]:
    """Where an array's numbers lie in memory, and the steps between them (a transpose begins at the same place)."""
    return (int(array.__array_interface__["data"][0]), *array.strides)


def union(*scopes: Iterable[Variable]) -> tuple[Variable, ...]:
    """Variables of all the scopes, each once, in order of first appearance."""
    return tuple(dict.fromkeys(variable for scope in scopes for variable in scope))
