"""Many product beliefs over the same blocks, side by side: what is believed in each of many simulated worlds.

Belief arrays are (states, members), so the beliefs of all scenarios are members too: one operator is applied to all of
them at once, and one pass conditions them. Scenarios whose known values or actions differ are taken group by group
where a table reads those values. Equal, scenario by scenario, to `ProductBelief.predict` and `condition`.
Memory: one number for each state, member and scenario.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Bool, Float, Int

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.beliefs.kernels import reweigh
from factored_pomdp.beliefs.plan import Seen
from factored_pomdp.beliefs.roster import Members
from factored_pomdp.variables import Value, Variable
from solvers.foresight.worlds import Places

__all__ = ["Crowd"]


@dataclass(frozen=True, eq=False)
class Crowd:
    """The beliefs of many scenarios.

    Attributes
    ----------
    template : ProductBelief
        A belief over the same blocks.
    arrays : tuple of (states, scenarios * members) float
        One a stack; the members of a scenario lie next to each other.
    known : dict of (scenarios,) int
        Position of each known value.
    """

    template: ProductBelief
    arrays: tuple[Float[np.ndarray, "_states _columns"], ...]
    known: Places

    @classmethod
    def of(cls, belief: ProductBelief, scenarios: int) -> Crowd:
        """The same belief in every scenario; all its known values have been read."""
        model = belief.plan.structure.model
        known = {name: np.full(scenarios, model.variable(name).index(value)) for name, value in belief.known.items()}
        return cls(belief, tuple(np.tile(array, (1, scenarios)) for array in belief.arrays), known)

    @property
    def scenarios(self) -> int:
        """How many there are."""
        if self.known:
            return len(next(iter(self.known.values())))
        return next(a.shape[1] // len(members) for members, a in zip(self.stacks, self.arrays, strict=True) if members)

    @property
    def stacks(self) -> tuple[Members, ...]:
        """Whose columns the arrays hold, in every scenario."""
        return self.template.roster.stacks

    def some(self, scenarios: Bool[np.ndarray, " scenarios"]) -> Crowd:
        """The beliefs of some scenarios."""
        if scenarios.all():
            return self
        chosen = [np.repeat(scenarios, len(members)) for members in self.stacks]
        arrays = tuple(np.ascontiguousarray(a[:, c]) for a, c in zip(self.arrays, chosen, strict=True))
        return replace(self, arrays=arrays, known={name: places[scenarios] for name, places in self.known.items()})

    def belief(self, scenario: int) -> ProductBelief:
        """That of one scenario, by itself."""
        model = self.template.plan.structure.model
        known = {name: model.variable(name).values[int(places[scenario])] for name, places in self.known.items()}
        columns = [slice(scenario * len(members), (scenario + 1) * len(members)) for members in self.stacks]
        return self.template.with_arrays([a[:, c] for a, c in zip(self.arrays, columns, strict=True)], known)

    def after(self, actions: Places, known: Places, seen: Places) -> Crowd:
        """The beliefs after a step.

        Parameters
        ----------
        actions, known, seen : mappings to (scenarios,) int
            What was done, the known variables' next values, what was observed.
        """
        following = {f"{name}.next": places for name, places in known.items()}
        at = _Told({**self.known, **actions, **following}, {**seen, **following})
        arrays = []
        for members, array in zip(self.stacks, self.arrays, strict=True):
            for early in (s for s in members.plan.seen if s.early):
                array = _weighed(members, early, array, at)
            array = _predicted(members, array, at)
            for late in (s for s in members.plan.seen if not s.early):
                array = _weighed(members, late, array, at)
            arrays.append(array)
        return replace(self, arrays=tuple(arrays), known=dict(known))


@dataclass(frozen=True)
class _Told:
    """Positions of values, scenario by scenario: those that tables read, and those that were seen."""

    given: Mapping[str, Int[np.ndarray, " scenarios"]]
    seen: Mapping[str, Int[np.ndarray, " scenarios"]]


def _predicted(members: Members, array: np.ndarray, at: _Told) -> np.ndarray:
    prediction = members.plan.prediction
    result = None
    for columns, assignment in _groups(members, prediction.context, at.given):
        if columns is None:
            return prediction.apply(array, assignment)
        result = np.empty_like(array) if result is None else result
        result[:, columns] = prediction.apply(np.ascontiguousarray(array[:, columns]), assignment)
    return array if result is None else result


def _weighed(members: Members, seen: Seen, array: np.ndarray, at: _Told) -> np.ndarray:
    """The array given one thing that was seen; a column that the model calls impossible stays as it was."""
    if seen.child.size == 1:
        places = np.zeros(array.shape[1], dtype=np.int64)
    else:
        places = np.stack([at.seen[name] for name in members.called(seen.child.name)], axis=1).ravel()
    likelihood = None
    for columns, assignment in _groups(members, seen.likelihood.rest, at.given):
        if columns is None:
            likelihood = seen.likelihood.columns(places, assignment)
            break
        part = seen.likelihood.columns(places[columns], assignment)
        likelihood = np.empty((len(part), array.shape[1])) if likelihood is None else likelihood
        likelihood[:, columns] = part
    if likelihood is None:
        return array
    result, impossible = reweigh(array, seen.context, likelihood)
    result[:, impossible] = array[:, impossible]
    return result


def _groups(
    members: Members, context: Sequence[Variable], given: Mapping[str, Int[np.ndarray, " scenarios"]]
) -> Iterator[tuple[Int[np.ndarray, " columns"] | None, dict[str, Value]]]:
    """Columns whose context has the same values, with those values; ``None`` stands for all columns."""
    if not context:
        yield None, {}
        return
    own = [members.called(variable.name) for variable in context]
    rows = np.stack([np.stack([given[name] for name in names], axis=1).ravel() for names in own])
    keys = np.ravel_multi_index(tuple(rows), [variable.size for variable in context])
    distinct, group = np.unique(keys, return_inverse=True)
    for number in range(len(distinct)):
        columns = np.flatnonzero(group == number)
        first: Any = rows[:, columns[0]]
        assignment = {v.name: v.values[int(place)] for v, place in zip(context, first, strict=True)}
        yield (None if len(distinct) == 1 else columns), assignment
