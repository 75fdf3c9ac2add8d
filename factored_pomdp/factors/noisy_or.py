"""Causal independence: any of these parents does it, and the first that does decides what is seen."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors.base import MAX_ENTRIES, Factor, address
from factored_pomdp.factors.dense import DenseFactor
from factored_pomdp.factors.sparse import SparseFactor, unflatten
from factored_pomdp.variables import Value, Variable, count

__all__ = ["Cause", "NoisyOr"]


@dataclass(frozen=True, eq=False)
class Cause:
    """One parent of a noisy-or.

    Attributes
    ----------
    variable : Variable or None
        The parent; ``None`` for a cause that has no parent (a leak).
    activation : (values, contexts) float
        Probability that this cause acts, for each value of its variable and each assignment of the context.
    emission : (contexts, child values) scipy sparse array
        What the child shows if this cause decides; rows sum to one, none of it on the child's ``off`` value.
    """

    variable: Variable | None
    activation: np.ndarray
    emission: Any


class NoisyOr(Factor):
    """``P(child | context, causes)`` where each cause acts independently, given the context.

    The child is ``off`` if no cause acts. Otherwise the first acting cause, in the order given, draws the child's value
    from its emission. With a child of two values and no context this is Pearl's noisy-or; in general the table over all
    causes is never made. Memory: one number for each (value of a cause, context), and the emissions.

    Parameters
    ----------
    context : iterable of Variable
    child : Variable
    off : value of the child
    causes : iterable of Cause
    """

    def __init__(self, context: Iterable[Variable], child: Variable, off: Value, causes: Iterable[Cause]) -> None:
        self.context, self.child, self.off = tuple(context), child, off
        self.off_index = child.index(off)
        self.causes = tuple(causes)
        self.cause_variables = tuple(cause.variable for cause in self.causes if cause.variable is not None)
        self.scope = (*self.context, *self.cause_variables, child)
        twice = [name for name, times in Counter(self.names).items() if times > 1]
        if twice:
            raise ValueError(f"noisy-or of {child.name!r}: {', '.join(twice)} more than once among context and causes")
        contexts = count(self.context)
        for cause in self.causes:
            values = cause.variable.size if cause.variable is not None else 1
            name = cause.variable.name if cause.variable is not None else "leak"
            if cause.activation.shape != (values, contexts):
                raise ValueError(f"activation of {name}: shape {cause.activation.shape}, expected {(values, contexts)}")
            if cause.emission.shape != (contexts, child.size):
                raise ValueError(f"emission of {name}: shape {cause.emission.shape}, expected {(contexts, child.size)}")

    @property
    def storage(self) -> tuple[int, ...]:
        tables = [(cause.activation, *_arrays(cause.emission)) for cause in self.causes]
        return (self.off_index, len(self.context), *(n for arrays in tables for a in arrays for n in address(a)))

    @property
    def stored(self) -> int:
        return sum(cause.activation.size + cause.emission.nnz for cause in self.causes)

    def renamed(self, names: Mapping[str, str]) -> NoisyOr:
        if not any(names.get(name, name) != name for name in self.names):
            return self

        def new(variable: Variable) -> Variable:
            return variable.renamed(names.get(variable.name, variable.name))

        causes = [replace(c, variable=None if c.variable is None else new(c.variable)) for c in self.causes]
        return NoisyOr([new(variable) for variable in self.context], new(self.child), self.off, causes)

    def at(self, assignment: Mapping[str, Value]) -> NoisyOr:
        """Causes at fixed values; a cause whose value is ``None`` is absent and never acts."""
        causes = []
        for cause in self.causes:
            if cause.variable is None or cause.variable.name not in assignment:
                causes.append(cause)
            elif (value := assignment[cause.variable.name]) is not None:
                row = cause.activation[cause.variable.index(value)][None]
                causes.append(Cause(None, row, cause.emission))
        return NoisyOr(self.context, self.child, self.off, causes)

    def condition(self, assignment: Mapping[str, Value]) -> Factor:
        fixed = self.at(assignment)
        if not fixed.cause_variables:
            return fixed.sparse().condition(assignment)
        fixed = fixed._within(assignment)
        if self.child.name not in assignment:
            return fixed
        if assignment[self.child.name] == self.off:
            return fixed.silence()
        return fixed.sparse().condition(assignment)

    def _within(self, assignment: Mapping[str, Value]) -> NoisyOr:
        """Those rows of the context where it has some values."""
        if not any(variable.name in assignment for variable in self.context):
            return self
        left = tuple(variable for variable in self.context if variable.name not in assignment)
        numbered = DenseFactor(self.context, np.arange(count(self.context)).reshape([v.size for v in self.context]))
        rows = numbered.condition(assignment).array.astype(np.int64).ravel()
        emissions = {id(cause.emission): cause.emission.tocsr()[rows] for cause in self.causes}
        causes = [Cause(c.variable, c.activation[:, rows], emissions[id(c.emission)]) for c in self.causes]
        return NoisyOr(left, self.child, self.off, causes)

    def silence(self) -> DenseFactor:
        """Probability of the child's ``off`` value over context and causes: the product of ``1 − activation``."""
        scope = (*self.context, *self.cause_variables)
        self.refuse_if_large(scope)
        table = np.ones((count(self.context),))
        for cause in self.causes:
            table = table[..., None] * (1 - cause.activation.T).reshape(
                (count(self.context),) + (1,) * (table.ndim - 1) + (-1,)
            )
            if cause.variable is None:
                table = table[..., 0]
        return DenseFactor(scope, table.reshape([variable.size for variable in scope]))

    def likelihoods(self) -> Any:
        """``P(child | context)`` as a sparse (contexts, child values) array; every cause must be at a fixed value."""
        from scipy import sparse

        if self.cause_variables:
            raise ValueError(f"causes without a value: {[variable.name for variable in self.cause_variables]}")
        contexts = count(self.context)
        silent = np.ones(contexts)
        total = sparse.csr_array((contexts, self.child.size))
        for cause in self.causes:
            acting = silent * cause.activation[0]
            if acting.any():
                total = total + cause.emission.multiply(acting[:, None]).tocsr()
            silent = silent * (1 - cause.activation[0])
        off = sparse.csr_array((silent, (np.arange(contexts), np.full(contexts, self.off_index))), total.shape)
        return (total + off).tocsr()

    def sparse(self) -> SparseFactor:
        combinations = math.prod(variable.size for variable in self.cause_variables)
        widest = sum(cause.emission.nnz for cause in self.causes) + count(self.context)
        if combinations * widest > MAX_ENTRIES:
            raise TooLarge(
                f"expanding the noisy-or of {self.child.name!r} over {len(self.cause_variables)} causes would hold "
                f"up to {combinations * widest:,} entries, more than {MAX_ENTRIES:,}; condition on the causes first"
            )
        coordinates, numbers = [], []
        for key in unflatten(np.arange(combinations), self.cause_variables):
            values = {v.name: v.values[int(index)] for v, index in zip(self.cause_variables, key, strict=True)}
            table = self.at(values).likelihoods().tocoo()
            fixed = np.broadcast_to(key, (len(table.data), len(key)))
            coordinates.append(np.concatenate([unflatten(table.row, self.context), fixed, table.col[:, None]], axis=1))
            numbers.append(table.data)
        flat = np.concatenate(numbers)
        kept = flat != 0
        return SparseFactor(self.scope, np.concatenate(coordinates)[kept], flat[kept])

    def dense(self) -> DenseFactor:
        self.refuse_if_large(self.scope)
        return self.sparse().dense()

    def marginalise(self, *variables: Variable) -> Factor:
        if set(variables) == {self.child}:
            rest = (*self.context, *self.cause_variables)
            self.refuse_if_large(rest)
            return DenseFactor(rest, np.ones([variable.size for variable in rest]))
        return super().marginalise(*variables)


def _arrays(emission: Any) -> tuple[np.ndarray, ...]:
    """The arrays of a compressed sparse table; two tables may share some of them."""
    return emission.data, emission.indices, emission.indptr
