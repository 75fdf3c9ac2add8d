"""Which variables make a numeric difference to a factor, shown by two assignments that differ in that one alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from factored_pomdp.factors import Cause, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.variables import Value, Variable

__all__ = ["Influences", "Reducer", "Witness", "influence"]

_SAME = 1e-12


@dataclass(frozen=True)
class Witness:
    """Two values of one variable between which a factor differs, everything else held.

    Attributes
    ----------
    values : (value, value)
    others : dict
        Values of (some of) the other variables in the scope.
    """

    values: tuple[Value, Value]
    others: dict[str, Value]


class Influences:
    """`influence`, computed once for factors that share their tables."""

    def __init__(self) -> None:
        self._found: dict[tuple[object, ...], tuple[Witness | None, Factor]] = {}

    def of(self, factor: Factor, variable: Variable) -> Witness | None:
        """As `influence`."""
        key = (*factor.storage, factor.scope.index(variable), *(id(v.values) for v in factor.scope))
        if key not in self._found:
            self._found[key] = influence(factor, variable), factor
        witness, first = self._found[key]
        if witness is None or first.names == factor.names:
            return witness
        new = dict(zip(first.names, factor.names, strict=True))
        return Witness(witness.values, {new[name]: value for name, value in witness.others.items()})

    def scope(self, factor: Factor) -> tuple[Variable, ...]:
        """The variables of the scope that make a numeric difference."""
        return tuple(variable for variable in factor.scope if self.of(factor, variable) is not None)


class Reducer:
    """Leaves out the variables that make no difference, once for factors that share their tables."""

    def __init__(self) -> None:
        self._influences = Influences()
        self._done: dict[tuple[object, ...], tuple[Factor, Factor]] = {}

    def reduced(self, factor: Factor, child: str | None) -> Factor:
        """The factor without its idle variables; its ``child`` stays."""
        position = factor.names.index(child) if child is not None else None
        key = (*factor.storage, position, *(id(variable.values) for variable in factor.scope))
        if key not in self._done:
            kept = {variable.name for variable in self._influences.scope(factor)} | {child}
            idle = {variable.name: variable.values[0] for variable in factor.scope if variable.name not in kept}
            self._done[key] = factor, factor.condition(idle) if idle else factor
        first, short = self._done[key]
        return (
            short if first.names == factor.names else short.renamed(dict(zip(first.names, factor.names, strict=True)))
        )


def influence(factor: Factor, variable: Variable) -> Witness | None:
    """Where a variable makes a difference to a factor, or ``None`` if it never does."""
    if variable.size == 1:
        return None
    if isinstance(factor, DeterministicFactor) and variable != factor.child:
        return _in_array(factor.indexes.astype(float), factor.parents, variable)
    if isinstance(factor, NoisyOr):
        return _in_noisy_or(factor, variable)
    if isinstance(factor, SparseFactor):
        return _in_sparse(factor, variable)
    table = factor.dense()
    return _in_array(table.array, table.scope, variable)


def _in_array(array: np.ndarray, scope: tuple[Variable, ...], variable: Variable) -> Witness | None:
    axis = scope.index(variable)
    lines = np.moveaxis(array, axis, -1)
    spread = lines.max(axis=-1) - lines.min(axis=-1)
    position = np.unravel_index(int(spread.argmax()), spread.shape)
    if spread[position] <= _SAME:
        return None
    line = lines[position]
    others = [other for other in scope if other != variable]
    at = {other.name: other.values[int(index)] for other, index in zip(others, position, strict=True)}
    return Witness((variable.values[int(line.argmax())], variable.values[int(line.argmin())]), at)


def _in_sparse(factor: SparseFactor, variable: Variable) -> Witness | None:
    others = tuple(other for other in factor.scope if other != variable)
    if not len(factor.numbers):
        return None
    keys, positions = np.unique(factor.flat(others), return_inverse=True)
    positions = positions.ravel()
    largest = np.full(len(keys), -np.inf)
    smallest = np.full(len(keys), np.inf)
    np.maximum.at(largest, positions, factor.numbers)
    np.minimum.at(smallest, positions, factor.numbers)
    complete = np.bincount(positions, minlength=len(keys)) == variable.size
    spread = np.where(complete, largest - smallest, np.maximum(largest, 0) - np.minimum(smallest, 0))
    group = int(spread.argmax())
    if spread[group] <= _SAME:
        return None
    line = np.zeros(variable.size)
    rows = positions == group
    line[factor.coordinates[rows, factor.scope.index(variable)]] = factor.numbers[rows]
    index = unflatten(keys[group : group + 1], others)[0]
    at = {other.name: other.values[int(i)] for other, i in zip(others, index, strict=True)}
    return Witness((variable.values[int(line.argmax())], variable.values[int(line.argmin())]), at)


def _in_noisy_or(factor: NoisyOr, variable: Variable) -> Witness | None:
    if variable == factor.child:
        return Witness((factor.off, next(value for value in variable.values if value != factor.off)), {})
    for number, cause in enumerate(factor.causes):
        if cause.variable == variable:
            spread = (cause.activation.max(axis=0) - cause.activation.min(axis=0)) * _decides(factor, number)
            context = int(spread.argmax())
            if spread[context] > _SAME:
                line = cause.activation[:, context]
                at = dict(zip((v.name for v in factor.context), _values(factor, context), strict=True))
                return Witness((variable.values[int(line.argmax())], variable.values[int(line.argmin())]), at)
    if variable in factor.context:
        for cause in factor.causes:
            for row in range(len(cause.activation)):
                table = cause.activation[row].reshape([v.size for v in factor.context])
                if (witness := _in_array(table, factor.context, variable)) is not None:
                    return _with_cause(witness, cause.variable, row)
        return _through_emission(factor, variable)
    return None


def _decides(factor: NoisyOr, number: int) -> np.ndarray:
    """How far, for each context, it can matter to the child whether a cause acts."""
    cause, later = factor.causes[number], factor.causes[number + 1 :]
    heard, silence = (_can_be_silent(causes, cause.activation.shape[1]) for causes in (factor.causes[:number], later))
    shows_else = np.zeros(len(silence))
    for other in later:
        if other.emission is not cause.emission:
            apart = np.abs(cause.emission - other.emission).max(axis=1).toarray().ravel()
            shows_else = np.maximum(shows_else, apart * other.activation.max(axis=0))
    return np.asarray(heard * np.maximum(silence, shows_else))


def _can_be_silent(causes: tuple[Cause, ...], contexts: int) -> np.ndarray:
    silent = np.ones(contexts)
    for cause in causes:
        silent = silent * (1 - cause.activation.min(axis=0))
    return silent


def _through_emission(factor: NoisyOr, variable: Variable) -> Witness | None:
    for cause in factor.causes:
        acting = cause.activation.max(axis=0) > 0
        if not acting.any():
            continue
        table = cause.emission.multiply(acting[:, None]).tocoo()
        contexts = unflatten(table.row.astype(np.int64), factor.context)
        shown = SparseFactor(
            (*factor.context, factor.child), np.concatenate([contexts, table.col[:, None]], axis=1), table.data
        )
        if (witness := _in_sparse(shown, variable)) is not None:
            return _with_cause(witness, cause.variable, int(cause.activation.max(axis=1).argmax()))
    return None


def _with_cause(witness: Witness, parent: Variable | None, row: int) -> Witness:
    if parent is None:
        return witness
    return Witness(witness.values, {**witness.others, parent.name: parent.values[row]})


def _values(factor: NoisyOr, context: int) -> list[Value]:
    index = unflatten(np.array([context]), factor.context)[0]
    return [variable.values[int(i)] for variable, i in zip(factor.context, index, strict=True)]
