"""From the layers of a file to factors, with every fault at its line."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.files.boxes import Entries
from factored_pomdp.files.faults import FaultList
from factored_pomdp.files.layers import MOST_ENTRIES, Layers
from factored_pomdp.validation import TOLERANCE
from factored_pomdp.variables import Variable, count

__all__ = ["as_distribution", "as_factor", "as_reward"]

_SPARSE_FROM = 100_000
_SPARSE_BELOW = 0.25
_FEWER_EXCEPTIONS = "numbers that hold for many places to depend on fewer variables, or fewer exceptions to them"
_MOST_ROWS = 100
"""Faulty rows of one table that are listed one by one."""


def as_distribution(
    layers: Layers, scope: Sequence[Variable], child: Variable, where: str, faults: FaultList
) -> Factor | None:
    """The distribution of a child given those parents on which it depends, or ``None`` after its faults were noted.

    Where parts of the table are in doubt, only what is wrong whatever they mean is noted.

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
    rows = _rows(entries, scope, child)
    axes = [axis for axis in entries.axes if scope[axis] != child]
    touched, since = layers.doubts.rows(axes) if layers.doubts else (None, None)
    wrong = ~((entries.numbers >= 0) & (entries.numbers <= 1 + TOLERANCE))
    told = wrong if since is None else wrong & (entries.stamps > since[rows])
    for position in np.flatnonzero(told)[:_MOST_ROWS]:
        at = _at(kept, entries.coordinates[position])
        faults.note(
            int(entries.stamps[position]), where + at, f"{entries.numbers[position]:g}", "a probability in [0, 1]"
        )
    sums = _Sums.of(entries, rows, count(parents))
    off = ~(np.abs(sums.totals - 1) <= TOLERANCE)
    off[rows[wrong]] = False
    if touched is not None:
        off &= ~touched | (sums.whole & (sums.last > since))
    _note_sums(sums, off, parents, where, faults)
    return None if len(faults) > before or layers.doubts else as_factor(entries, kept)


def as_reward(layers: Layers, scope: Sequence[Variable], where: str, faults: FaultList) -> tuple[Factor, ...] | None:
    """A reward over those variables on which it depends, or ``None`` after its faults were noted.

    Returns
    -------
    tuple of Factor
        Their sum is the reward: one, or a base and differences from it where one alone would be too large a table
        (`factored_pomdp.files.defaults`).
    """
    if faults.full:
        return None
    parts = _reward_entries(layers, where, faults)
    before = len(faults)
    for entries in parts:
        for position in np.flatnonzero(~np.isfinite(entries.numbers))[:_MOST_ROWS]:
            at = _at([scope[axis] for axis in entries.axes], entries.coordinates[position])
            faults.note(int(entries.stamps[position]), where + at, f"{entries.numbers[position]:g}", "a finite number")
    if not parts or len(faults) > before or layers.doubts:
        return None
    said = [entries for entries in parts if len(entries.numbers)] or parts[:1]
    return tuple(as_factor(entries, [scope[axis] for axis in entries.axes]) for entries in said)


def as_factor(entries: Entries, scope: Sequence[Variable]) -> Factor:
    """A sparse factor where that is much smaller, else a dense one."""
    sparse = SparseFactor(scope, entries.coordinates, entries.numbers)
    large = count(scope) > _SPARSE_FROM and len(entries.numbers) < _SPARSE_BELOW * count(scope)
    if large:
        return sparse
    array = np.zeros([variable.size for variable in scope])
    array[tuple(entries.coordinates.T)] = entries.numbers if scope else entries.numbers.sum()
    return DenseFactor(scope, array)


@dataclass(frozen=True)
class _Sums:
    """What is said of each row: the sum, the last stamp (-1: none), and whether one statement says several numbers."""

    totals: np.ndarray
    last: np.ndarray
    whole: np.ndarray

    @classmethod
    def of(cls, entries: Entries, rows: np.ndarray, number: int) -> _Sums:
        last = np.full(number, -1, dtype=np.int64)
        np.maximum.at(last, rows, entries.stamps)
        mixed = np.zeros(number, dtype=bool)
        mixed[rows[entries.stamps != last[rows]]] = True
        totals = np.bincount(rows, weights=entries.numbers, minlength=number)
        return cls(totals, last, ~mixed & (np.bincount(rows, minlength=number) > 1))


def _reward_entries(layers: Layers, where: str, faults: FaultList) -> tuple[Entries, ...]:
    try:
        return (layers.entries(),)
    except TooLarge as problem:
        found = str(problem)
    try:
        return layers.base_and_differences()
    except TooLarge:
        faults.note(None, where, found, _FEWER_EXCEPTIONS if layers.has_wide_numbers() else "a smaller table")
        return ()


def _entries(layers: Layers, keep: Sequence[int], where: str, faults: FaultList) -> Entries | None:
    if faults.full:
        return None
    try:
        if layers.doubts:
            with suppress(TooLarge):
                return layers.entries([*keep, *layers.doubts.axes])
        found = layers.entries(keep)
    except TooLarge as problem:
        faults.note(None, where, str(problem), "a smaller table")
        return None
    return None if layers.doubts else found


def _rows(entries: Entries, scope: Sequence[Variable], child: Variable) -> np.ndarray:
    rows = np.zeros(len(entries.numbers), dtype=np.int64)
    for column, axis in enumerate(entries.axes):
        if scope[axis] != child:
            rows = rows * scope[axis].size + entries.coordinates[:, column]
    return rows


def _note_sums(sums: _Sums, off: np.ndarray, parents: Sequence[Variable], where: str, faults: FaultList) -> None:
    positions = np.flatnonzero(off)
    for position in positions[:_MOST_ROWS]:
        at = unflatten(np.array([position]), tuple(parents))[0]
        stamp = int(sums.last[position])
        found = "no distribution" if stamp < 0 else f"probabilities that sum to {sums.totals[position]:.9g}"
        faults.note(stamp if stamp >= 0 else None, where + _at(parents, at), found, "sum 1")
    if len(positions) > _MOST_ROWS:
        faults.note(None, where, f"{len(positions) - _MOST_ROWS:,} more such distributions", "sum 1")


def _at(variables: Sequence[Variable], index: np.ndarray) -> str:
    if not variables:
        return ""
    return " at " + ", ".join(f"{v.name}={v.values[int(i)]}" for v, i in zip(variables, index, strict=True))
