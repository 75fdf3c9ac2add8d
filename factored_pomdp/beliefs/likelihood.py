"""What an observation says about the hidden variables of a stack, for all its members at once."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol, runtime_checkable

import numpy as np

from factored_pomdp.factors import Cause, Factor, NoisyOr
from factored_pomdp.variables import Value, Variable, count

__all__ = ["Likelihood", "likelihood_of"]


@runtime_checkable
class Likelihood(Protocol):
    """``P(seen | hidden, rest)`` in columns."""

    hidden: tuple[Variable, ...]
    rest: tuple[Variable, ...]

    def columns(self, seen: np.ndarray, assignment: Mapping[str, Value]) -> np.ndarray:
        """(hidden assignments, members) likelihoods of the values ``seen`` (members,); negative: not looked at."""


class _Table:
    """From any factor that can be laid out in full."""

    def __init__(self, factor: Factor, child: Variable, hidden: tuple[Variable, ...]) -> None:
        self._factor, self._child, self.hidden = factor, child, hidden
        self.rest = tuple(variable for variable in factor.scope if variable != child and variable not in hidden)
        self._tables: dict[tuple[Value, ...], np.ndarray] = {}

    def columns(self, seen: np.ndarray, assignment: Mapping[str, Value]) -> np.ndarray:
        key = tuple(assignment[variable.name] for variable in self.rest)
        for variable, value in zip(self.rest, key, strict=True):
            if value is None:
                raise ValueError(f"{variable.name}=None: only a noisy-or can do without one of its parents")
        if key not in self._tables:
            at = self._factor.condition(dict(zip((v.name for v in self.rest), key, strict=True)))
            table = at.array_over([*self.hidden, self._child]).reshape(-1, self._child.size)
            self._tables[key] = np.concatenate([table, np.ones((len(table), 1))], axis=1)
        return np.ascontiguousarray(self._tables[key][:, seen])


class _NoisyOr:
    """From a noisy-or whose causes are known: one vector of silence, and a few entries for every detection."""

    def __init__(self, factor: NoisyOr, child: Variable, hidden: tuple[Variable, ...]) -> None:
        self._factor, self.hidden = factor, hidden
        self.rest = factor.cause_variables
        tables = list({id(cause.emission): cause.emission for cause in factor.causes}.values())
        columns = [table.tocsc() for table in tables]
        starts = np.cumsum([0] + [table.nnz for table in columns])[:-1]
        self._indptr = np.array([table.indptr + start for table, start in zip(columns, starts, strict=True)], np.int64)
        self._indptr = self._indptr.reshape(len(columns), child.size + 1)
        self._rows = np.concatenate([table.indices for table in columns] or [np.zeros(0)]).astype(np.int64)
        self._data = np.concatenate([table.data for table in columns] or [np.zeros(0)]).astype(float)
        position = {id(table): number for number, table in enumerate(tables)}
        self._emission_of = np.array([position[id(cause.emission)] for cause in factor.causes], np.int64)
        self._activation = np.concatenate(
            [np.zeros((0, count(factor.context))), *(c.activation for c in factor.causes)]
        )
        self._first = np.cumsum([0, *(len(cause.activation) for cause in factor.causes)])[:-1].tolist()

    def columns(self, seen: np.ndarray, assignment: Mapping[str, Value]) -> np.ndarray:
        from factored_pomdp.beliefs.kernels import noisy_or_columns

        causes = zip(self._first, self._factor.causes, strict=True)
        chosen = [first + _position(cause, assignment, absent=-1 - first) for first, cause in causes]
        emissions = (self._emission_of, self._indptr, self._rows, self._data)
        result = np.empty((self._activation.shape[1], len(seen)))
        noisy_or_columns(self._activation, np.array(chosen), *emissions, self._factor.off_index, seen, result)
        return result


def _position(cause: Cause, assignment: Mapping[str, Value], absent: int) -> int:
    """Of a cause's value; of one that has no variable the first."""
    if cause.variable is None:
        return 0
    value = assignment[cause.variable.name]
    return absent if value is None else cause.variable.index(value)


def likelihood_of(factor: Factor, child: Variable, hidden: tuple[Variable, ...]) -> Likelihood:
    """Columns of a likelihood over those of ``hidden`` that the factor reads, in the factor's own order."""
    if (
        isinstance(factor, NoisyOr)
        and set(factor.context) <= set(hidden)
        and not set(factor.cause_variables) & set(hidden)
    ):
        return _NoisyOr(factor, child, factor.context)
    return _Table(factor, child, tuple(variable for variable in factor.scope if variable in hidden))
