"""A distribution of several variables together, taken apart into one for each (the chain rule)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from factored_pomdp.factors import DenseFactor, Factor
from factored_pomdp.files.faults import FaultList
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.tables import as_distribution
from factored_pomdp.variables import Variable, count

__all__ = ["chained"]

_MOST_ENTRIES = 5_000_000
_SAME = 1e-12


def chained(
    layers: Layers,
    parents: Sequence[Variable],
    children: Sequence[Variable],
    where: str,
    stamp: int,
    faults: FaultList,
    *,
    tied: bool,
) -> dict[Variable, Factor]:
    """``P(x, y | parents)`` as ``P(x | parents)`` and ``P(y | x, parents)``; nothing after faults were noted.

    A child that does not depend on those before it does not get them as parents. Where those before it are impossible,
    it has the distribution that it has without them.

    Parameters
    ----------
    layers : Layers
        Axes: parents, then children.
    stamp : int
        Where the function stands.
    tied : bool
        Whether a child may depend on another.
    """
    size = count(parents) * count(children)
    if size > _MOST_ENTRIES:
        faults.note(stamp, where, f"{size:,} entries", f"at most {_MOST_ENTRIES:,} for several variables together")
        return {}
    together = Variable(" and ".join(child.name for child in children), range(count(children)))
    scope = [*parents, together]
    before = len(faults)
    joined = as_distribution(_merged(layers, len(parents), together.size), scope, together, where, faults)
    if joined is None or len(faults) > before:
        return {}
    rows = [variable.size for variable in parents]
    table = np.broadcast_to(joined.array_over(scope), [*rows, together.size])
    table = table.reshape(*rows, *(child.size for child in children))
    return _split(table, parents, children, where, stamp, faults, tied=tied)


def _merged(layers: Layers, parents: int, size: int) -> Layers:
    """The same table with the children's axes made into one."""
    entries = layers.entries(keep=range(len(layers.shape)))
    merged = Layers([*layers.shape[:parents], size])
    inner = layers.shape[parents:]
    last = np.ravel_multi_index(tuple(entries.coordinates[:, parents:].T), inner)
    order = np.argsort(entries.stamps, kind="stable")
    coordinates = np.column_stack([entries.coordinates[:, :parents], last])
    merged.scalars(coordinates[order], entries.numbers[order], entries.stamps[order])
    for (box, _), stamp in layers.doubts.boxes.items():
        merged.doubts.add([*box[:parents], -1], max(stamp, int(entries.stamps.max(initial=-1))))
    return merged


def _split(
    table: np.ndarray,
    parents: Sequence[Variable],
    children: Sequence[Variable],
    where: str,
    stamp: int,
    faults: FaultList,
    *,
    tied: bool,
) -> dict[Variable, Factor]:
    given = len(parents)
    found: dict[Variable, Factor] = {}
    for position, child in enumerate(children):
        later = tuple(range(given + position + 1, given + len(children)))
        earlier = tuple(range(given, given + position))
        through = table.sum(axis=later)
        alone = through.sum(axis=earlier)
        mass = through.sum(axis=-1, keepdims=True)
        wide = alone.reshape(*alone.shape[:given], *([1] * position), child.size)
        conditional = np.where(
            mass > 0, through / np.where(mass > 0, mass, 1.0), wide / wide.sum(axis=-1, keepdims=True)
        )
        if np.abs(conditional - wide).max() <= _SAME:
            found[child] = _without_idle(DenseFactor([*parents, child], alone), child)
        elif tied:
            found[child] = _without_idle(DenseFactor([*parents, *children[:position], child], conditional), child)
        else:
            faults.note(stamp, where, f"{child.name} depending on the others", "observations that do not")
            return {}
    return found


def _without_idle(factor: DenseFactor, child: Variable) -> DenseFactor:
    """The same factor over those parents on which it depends."""
    scope, array = list(factor.scope), factor.array
    for variable in factor.scope:
        axis = scope.index(variable)
        if variable != child and math.isclose(np.ptp(array, axis=axis).max(), 0.0, abs_tol=_SAME):
            array = array.take(0, axis=axis)
            scope.pop(axis)
    return DenseFactor(scope, array)
