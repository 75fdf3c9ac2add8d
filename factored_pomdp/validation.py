"""Everything that can be wrong with a distribution or a reward, found at once and said with the parents' assignment."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from factored_pomdp.errors import Fault
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.variables import Variable, count

__all__ = ["TOLERANCE", "checked_distribution", "checked_reward", "is_certain"]

TOLERANCE = 1e-5
"""How far a column's sum may lie from one and still be renormalised (with a note)."""

_EXACT = 1e-9

_ROUNDING = 1e-13
"""What adding up may lose: nearer to one, a column stays as it was given (so that it stays the same however often)."""


def checked_distribution(factor: Factor, child: Variable, where: str, faults: list[Fault], notes: list[str]) -> Factor:
    """The factor, columns normalised (within rounding); faults and notes are added to the lists."""
    if isinstance(factor, DeterministicFactor) and factor.child == child:
        _check_indexes(factor, where, faults)
        return factor
    if isinstance(factor, NoisyOr) and factor.child == child:
        return _checked_noisy_or(factor, where, faults, notes)
    parents = tuple(variable for variable in factor.scope if variable != child)
    table = factor if isinstance(factor, SparseFactor) else factor.dense()
    if isinstance(table, SparseFactor) and _misplaced(table, where, faults):
        return factor
    numbers = table.numbers if isinstance(table, SparseFactor) else table.array.ravel()
    wrong = np.flatnonzero(~((numbers >= 0) & (numbers <= 1 + TOLERANCE)))
    for position in wrong:
        at = _entry(table, int(position))
        faults.append(Fault(f"{where}{_at(table.scope, at)}", f"{numbers[position]:g}", "a probability in [0, 1]"))
    sums = _sums(table, parents)
    wrong_columns = _columns(table, parents)[wrong] if len(wrong) else wrong
    off_one = ~(np.abs(sums - 1) <= TOLERANCE)
    off_one[wrong_columns] = False
    for position in np.flatnonzero(off_one):
        at = unflatten(np.array([position]), parents)[0]
        faults.append(Fault(f"{where}{_at(parents, at)}", f"probabilities that sum to {sums[position]:.9g}", "sum 1"))
    if len(wrong) or off_one.any():
        return factor
    off = int((np.abs(sums - 1) > _EXACT).sum())
    if off:
        worst = unflatten(np.array([np.abs(sums - 1).argmax()]), parents)[0]
        notes.append(
            f"{where}: {off} of {len(sums)} distributions renormalised (worst sum {sums[np.abs(sums - 1).argmax()]:.9g}"
            f"{_at(parents, worst)})"
        )
    sums[np.abs(sums - 1) <= _ROUNDING] = 1.0
    return _normalised(table, parents, sums) if (sums != 1).any() else table


def checked_reward(factor: Factor, where: str, faults: list[Fault]) -> Factor:
    """The factor; numbers that are not finite are noted as faults."""
    table = factor if isinstance(factor, SparseFactor) else factor.dense()
    if isinstance(table, SparseFactor) and _misplaced(table, where, faults):
        return factor
    numbers = table.numbers if isinstance(table, SparseFactor) else table.array.ravel()
    for position in np.flatnonzero(~np.isfinite(numbers)):
        at = _entry(table, int(position))
        faults.append(Fault(f"{where}{_at(table.scope, at)}", f"{numbers[position]:g}", "a finite number"))
    return factor


def is_certain(factor: Factor, child: str) -> bool:
    """Whether a distribution leaves no chance, whatever the parents."""
    if isinstance(factor, DeterministicFactor):
        return factor.child.name == child
    if isinstance(factor, NoisyOr):
        return False
    numbers = factor.numbers if isinstance(factor, SparseFactor) else factor.dense().array
    return bool(np.isin(numbers, (0.0, 1.0)).all())


def _sums(table: SparseFactor | DenseFactor, parents: tuple[Variable, ...]) -> np.ndarray:
    if isinstance(table, SparseFactor):
        return np.bincount(table.flat(parents), weights=table.numbers, minlength=count(parents))
    axis = next(axis for axis, variable in enumerate(table.scope) if variable not in parents)
    return table.array.sum(axis=axis).ravel()


def _columns(table: SparseFactor | DenseFactor, parents: tuple[Variable, ...]) -> np.ndarray:
    """For each stored number, which assignment of the parents it belongs to."""
    if isinstance(table, SparseFactor):
        return table.flat(parents)
    axis = next(axis for axis, variable in enumerate(table.scope) if variable not in parents)
    shape = [1 if position == axis else variable.size for position, variable in enumerate(table.scope)]
    numbered = np.arange(count(parents)).reshape(shape)
    return np.broadcast_to(numbered, table.array.shape).ravel()


def _normalised(table: SparseFactor | DenseFactor, parents: tuple[Variable, ...], sums: np.ndarray) -> Factor:
    if isinstance(table, SparseFactor):
        return SparseFactor(table.scope, table.coordinates, table.numbers / sums[table.flat(parents)])
    axis = next(axis for axis, variable in enumerate(table.scope) if variable not in parents)
    shape = [variable.size for variable in table.scope if variable in parents]
    return DenseFactor(table.scope, table.array / np.expand_dims(sums.reshape(shape), axis))


def _misplaced(table: SparseFactor, where: str, faults: list[Fault]) -> bool:
    """Note coordinates that lie outside of the scope, or that stand there twice."""
    before = len(faults)
    sizes = [variable.size for variable in table.scope]
    outside = ((table.coordinates < 0) | (table.coordinates >= sizes)).any(axis=1)
    for row in table.coordinates[outside]:
        faults.append(Fault(f"{where}, entry at position {tuple(row.tolist())}", "no such place", f"below {sizes}"))
    if not outside.any():
        keys, times = np.unique(table.flat(table.scope), return_counts=True)
        for index in unflatten(keys[times > 1], table.scope):
            faults.append(
                Fault(f"{where}{_at(table.scope, index)}", "several entries", "one entry for each assignment")
            )
    return len(faults) > before


def _check_indexes(factor: DeterministicFactor, where: str, faults: list[Fault]) -> None:
    flat = factor.indexes.ravel()
    for position in np.flatnonzero((flat < 0) | (flat >= factor.child.size)):
        at = unflatten(np.array([position]), factor.parents)[0]
        faults.append(
            Fault(
                f"{where}{_at(factor.parents, at)}", f"value number {flat[position]}", f"0 to {factor.child.size - 1}"
            )
        )


def _checked_noisy_or(factor: NoisyOr, where: str, faults: list[Fault], notes: list[str]) -> NoisyOr:
    before = len(faults)
    _check_noisy_or(factor, where, faults)
    if len(faults) > before:
        return factor
    emissions = {id(cause.emission): cause.emission for cause in factor.causes}
    off = 0
    for key, emission in emissions.items():
        sums = np.asarray(emission.sum(axis=1)).ravel()
        drifted = (np.abs(sums - 1) > _EXACT) & (sums > 0)
        if drifted.any():
            off += int(drifted.sum())
            emissions[key] = emission.multiply((1 / np.where(drifted, sums, 1.0))[:, None]).tocsr()
    if not off:
        return factor
    notes.append(f"{where}: {off} of its causes' emissions renormalised")
    causes = [replace(cause, emission=emissions[id(cause.emission)]) for cause in factor.causes]
    return NoisyOr(factor.context, factor.child, factor.off, causes)


def _check_noisy_or(factor: NoisyOr, where: str, faults: list[Fault]) -> None:
    for cause in factor.causes:
        name = cause.variable.name if cause.variable is not None else "leak"
        for value, context in np.argwhere(~((cause.activation >= 0) & (cause.activation <= 1))):
            at = _at(factor.context, unflatten(np.array([context]), factor.context)[0])
            label = cause.variable.values[int(value)] if cause.variable is not None else "always"
            faults.append(
                Fault(
                    f"{where}, cause {name}={label}{at}",
                    f"{cause.activation[value, context]:g}",
                    "a probability in [0, 1]",
                )
            )
        needed = cause.activation.max(axis=0) > 0
        sums = np.asarray(cause.emission.sum(axis=1)).ravel()
        for context in np.flatnonzero(needed & ~(np.abs(sums - 1) <= TOLERANCE)):
            at = _at(factor.context, unflatten(np.array([context]), factor.context)[0])
            faults.append(
                Fault(f"{where}, emission of {name}{at}", f"probabilities that sum to {sums[context]:.9g}", "sum 1")
            )
        if cause.emission.nnz and (cause.emission.data < 0).any():
            faults.append(Fault(f"{where}, emission of {name}", "a negative number", "probabilities"))
        if cause.emission.tocsc()[:, [factor.off_index]].sum() > 0:
            faults.append(
                Fault(f"{where}, emission of {name}", f"mass on {factor.off!r}", "none: that value means silence")
            )


def _entry(table: SparseFactor | DenseFactor, position: int) -> np.ndarray:
    if isinstance(table, SparseFactor):
        return np.asarray(table.coordinates[position])
    return unflatten(np.array([position]), table.scope)[0]


def _at(variables: tuple[Variable, ...], index: np.ndarray) -> str:
    if not variables:
        return ""
    return " at " + ", ".join(f"{v.name}={v.values[int(i)]}" for v, i in zip(variables, index, strict=True))
