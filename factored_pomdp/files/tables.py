"""From the layers of a file to factors, with every fault at its line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.files.faults import FaultList
from factored_pomdp.files.layers import MOST_ENTRIES, Entries, Layers
from factored_pomdp.validation import TOLERANCE
from factored_pomdp.variables import Variable, count

__all__ = ["as_distribution", "as_factor", "as_reward"]

_SPARSE_FROM = 100_000
_SPARSE_BELOW = 0.25
_MOST_ROWS = 100
"""Faulty rows of one table that are listed one by one."""


def as_distribution(
    layers: Layers, scope: Sequence[Variable], child: Variable, where: str, faults: FaultList
) -> Factor | None:
    """The distribution of a child given those parents on which it depends, or ``None`` after its faults were noted.

    Parameters
    ----------
    layers : Layers
        Axes as in ``scope``.
    """
    entries = _entries(layers, [scope.index(child)], where, faults)
    if entries is None:
        return None
    kept = [scope[axis] for axis in entries.axes]
    parents = [variable for variable in kept if variable != child]
    if count(parents) > MOST_ENTRIES:
        faults.note(None, where, f"{count(parents):,} distributions", f"at most {MOST_ENTRIES:,}")
        return None
    before = len(faults)
    wrong = ~((entries.numbers >= 0) & (entries.numbers <= 1 + TOLERANCE))
    for position in np.flatnonzero(wrong)[:_MOST_ROWS]:
        at = _at(kept, entries.coordinates[position])
        faults.note(
            int(entries.stamps[position]), where + at, f"{entries.numbers[position]:g}", "a probability in [0, 1]"
        )
    _check_sums(entries, kept, parents, wrong, where, faults)
    return None if len(faults) > before else as_factor(entries, kept)


def as_reward(layers: Layers, scope: Sequence[Variable], where: str, faults: FaultList) -> Factor | None:
    """A reward over those variables on which it depends, or ``None`` after its faults were noted."""
    entries = _entries(layers, [], where, faults)
    if entries is None:
        return None
    kept = [scope[axis] for axis in entries.axes]
    before = len(faults)
    for position in np.flatnonzero(~np.isfinite(entries.numbers))[:_MOST_ROWS]:
        at = _at(kept, entries.coordinates[position])
        faults.note(int(entries.stamps[position]), where + at, f"{entries.numbers[position]:g}", "a finite number")
    return None if len(faults) > before else as_factor(entries, kept)


def as_factor(entries: Entries, scope: Sequence[Variable]) -> Factor:
    """A sparse factor where that is much smaller, else a dense one."""
    sparse = SparseFactor(scope, entries.coordinates, entries.numbers)
    large = count(scope) > _SPARSE_FROM and len(entries.numbers) < _SPARSE_BELOW * count(scope)
    if large:
        return sparse
    array = np.zeros([variable.size for variable in scope])
    array[tuple(entries.coordinates.T)] = entries.numbers if scope else entries.numbers.sum()
    return DenseFactor(scope, array)


def _entries(layers: Layers, keep: Sequence[int], where: str, faults: FaultList) -> Entries | None:
    try:
        return layers.entries(keep)
    except TooLarge as problem:
        faults.note(None, where, str(problem), "a smaller table")
        return None


def _check_sums(
    entries: Entries,
    scope: Sequence[Variable],
    parents: Sequence[Variable],
    wrong: np.ndarray,
    where: str,
    faults: FaultList,
) -> None:
    rows = np.zeros(len(entries.numbers), dtype=np.int64)
    for axis, variable in enumerate(scope):
        if variable in parents:
            rows = rows * variable.size + entries.coordinates[:, axis]
    sums = np.bincount(rows, weights=entries.numbers, minlength=count(parents))
    off = ~(np.abs(sums - 1) <= TOLERANCE)
    off[rows[wrong]] = False
    stamps = np.full(len(sums), -1, dtype=np.int64)
    np.maximum.at(stamps, rows, entries.stamps)
    positions = np.flatnonzero(off)
    for position in positions[:_MOST_ROWS]:
        at = unflatten(np.array([position]), tuple(parents))[0]
        stamp = int(stamps[position])
        found = "no distribution" if stamp < 0 else f"probabilities that sum to {sums[position]:.9g}"
        faults.note(stamp if stamp >= 0 else None, where + _at(parents, at), found, "sum 1")
    if len(positions) > _MOST_ROWS:
        faults.note(None, where, f"{len(positions) - _MOST_ROWS:,} more such distributions", "sum 1")


def _at(variables: Sequence[Variable], index: np.ndarray) -> str:
    if not variables:
        return ""
    return " at " + ", ".join(f"{v.name}={v.values[int(i)]}" for v, i in zip(variables, index, strict=True))
