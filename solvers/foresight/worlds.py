"""Many worlds of one model at once: hidden states drawn from a product belief, then stepped side by side.

Values are positions, an array a variable with a place for each world. Every draw takes its uniform number from outside,
so that worlds which are given the same numbers differ only where their actions make a difference (common random
numbers). The laws are those of `factored_pomdp.simulation.Simulation`, which steps one world.
Time of a step: one look-up a variable and world. Memory: one more copy of every distinct table, sorted by its parents.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from jaxtyping import Float, Int

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.factors import Factor, NoisyOr
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable

__all__ = ["Places", "Worlds"]

Places = Mapping[str, Int[np.ndarray, " worlds"]]
"""Position of a variable's value in each world."""


class Worlds:
    """A model's laws, compiled to be drawn from for many worlds at once.

    Parameters
    ----------
    model : FactoredPOMDP

    Attributes
    ----------
    numbers : int
        Uniform numbers that a step of one world takes.
    """

    def __init__(self, model: FactoredPOMDP) -> None:
        self.model = model
        laws = {f"{name}.next": factor for name, factor in model.transition.items()} | dict(model.observation)
        lines: dict[tuple[int, ...], _Lines] = {}
        self._laws = [_law(factor, factor.variable(name), lines) for name, factor in _in_order(laws)]
        self.numbers = sum(law.numbers for law in self._laws)

    def drawn(self, belief: ProductBelief, worlds: int, rng: np.random.Generator) -> dict[str, np.ndarray]:
        """States of some worlds, independent draws from a belief whose known values have all been read."""
        known = {name: self.model.variable(name).index(value) for name, value in belief.known.items()}
        places = {name: np.full(worlds, place) for name, place in known.items()}
        for plan, array, members in zip(belief.plan.stacks, belief.arrays, belief.members, strict=True):
            for column, names in enumerate(members):
                states = rng.choice(len(array), size=worlds, p=array[:, column] / array[:, column].sum())
                for variable, axis in zip(plan.variables, np.unravel_index(states, plan.shape), strict=True):
                    places[names[variable.name]] = axis
        return places

    def step(
        self, states: Places, actions: Places, uniform: Float[np.ndarray, "numbers worlds"]
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Next states and observations."""
        at = {**states, **actions}
        row = 0
        for law in self._laws:
            at[law.child.name] = law.draw(at, uniform[row : row + law.numbers])
            row += law.numbers
        after = {variable.name: at[variable.next.name] for variable in self.model.states}
        return after, {variable.name: at[variable.name] for variable in self.model.observations}


class _Lines:
    """A table of probabilities, sorted by the child's parents, with running totals to search in."""

    def __init__(self, factor: Factor, child: Variable) -> None:
        table = factor.sparse()
        keys = table.flat([variable for variable in factor.scope if variable != child])
        order = np.lexsort((table.coordinates[:, table.scope.index(child)], keys))
        order = order[table.numbers[order] > 0]
        self.keys, self.places = keys[order], table.coordinates[order, table.scope.index(child)]
        self.totals = np.concatenate([[0.0], np.cumsum(table.numbers[order])])

    def draw(self, keys: np.ndarray, uniform: np.ndarray) -> np.ndarray:
        """A value of the child for each position of the parents."""
        first, last = np.searchsorted(self.keys, keys, "left"), np.searchsorted(self.keys, keys, "right")
        wanted = self.totals[first] + uniform * (self.totals[last] - self.totals[first])
        found = np.searchsorted(self.totals, wanted, "right") - 1
        return np.asarray(self.places[np.clip(found, first, np.maximum(first, last - 1))])


class _Law:
    """Draws one variable from its table."""

    numbers = 1

    def __init__(self, factor: Factor, child: Variable, lines: dict[tuple[int, ...], _Lines]) -> None:
        self.child, self._parents = child, tuple(variable for variable in factor.scope if variable != child)
        key = (*factor.storage, factor.scope.index(child), *(variable.size for variable in factor.scope))
        if key not in lines:
            lines[key] = _Lines(factor, child)
        self._lines = lines[key]

    def draw(self, at: Places, uniform: np.ndarray) -> np.ndarray:
        """One value a world."""
        return self._lines.draw(np.broadcast_to(_flat(self._parents, at), uniform[0].shape), uniform[0])


class _FirstToAct:
    """Draws the child of a noisy-or: its causes act one after the other, and the first that does says what is seen."""

    def __init__(self, factor: NoisyOr) -> None:
        self.child, self._factor = factor.child, factor
        self.numbers = len(factor.causes) + 1
        self._shown = {id(cause.emission): _running(cause.emission) for cause in factor.causes}

    def draw(self, at: Places, uniform: np.ndarray) -> np.ndarray:
        """One value a world."""
        context = np.broadcast_to(_flat(self._factor.context, at), uniform[0].shape)
        seen = np.full(len(context), self._factor.off_index)
        silent = np.ones(len(context), dtype=bool)
        for cause, number in zip(self._factor.causes, uniform, strict=False):
            row = np.zeros(len(context), dtype=int) if cause.variable is None else at[cause.variable.name]
            acts = silent & (number < cause.activation[row, context])
            if acts.any():
                start, columns, totals = self._shown[id(cause.emission)]
                first, last = start[context[acts]], start[context[acts] + 1]
                wanted = totals[first] + uniform[-1][acts] * (totals[last] - totals[first])
                found = np.searchsorted(totals, wanted, "right") - 1
                seen[acts] = columns[np.clip(found, first, last - 1)]
            silent &= ~acts
        return seen


def _law(factor: Factor, child: Variable, lines: dict[tuple[int, ...], _Lines]) -> Any:
    return _FirstToAct(factor) if isinstance(factor, NoisyOr) else _Law(factor, child, lines)


def _running(emission: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    table = emission.tocsr()
    return table.indptr, table.indices, np.concatenate([[0.0], np.cumsum(table.data)])


def _flat(variables: tuple[Variable, ...], at: Places) -> Any:
    """Row-major position within the table over some variables."""
    flat: Any = np.zeros(1, dtype=np.int64)
    for variable in variables:
        flat = flat * variable.size + at[variable.name]
    return flat


def _in_order(laws: Mapping[str, Factor]) -> list[tuple[str, Factor]]:
    """Distributions in an order in which every parent of the same slice comes first."""
    left, ordered = dict(laws), []
    while left:
        ready = [n for n, factor in left.items() if not any(v.name in left for v in factor.scope if v.name != n)]
        ordered += [(name, left.pop(name)) for name in ready]
    return ordered
