"""Beliefs over the rows of a flat model; what a vector policy is asked with while it runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import JointBelief, ProductBelief
from factored_pomdp.beliefs.comparison import joint_of
from factored_pomdp.errors import ImpossibleObservation
from factored_pomdp.structure import GOES_ON
from factored_pomdp.variables import Value
from solvers.flat import FlatModel

__all__ = ["FlatBelief", "vector_of"]


@dataclass(frozen=True, eq=False)
class FlatBelief:
    """A belief as a vector; as in the other beliefs, it is given that the episode goes on.

    Attributes
    ----------
    vector : (N,) float
        In the flat model's own order of states.
    steps : int
        Actions taken since the start.
    action : int or None
        The last one, where its observation is still to come.
    """

    flat: FlatModel
    vector: Float[np.ndarray, " states"]
    steps: int = 0
    action: int | None = None

    @classmethod
    def initial(cls, flat: FlatModel) -> FlatBelief:
        """The model's initial belief."""
        return cls(flat, flat.initial)._running()

    def predict(self, action: Any) -> FlatBelief:
        """``Σ_s P(s' | s, a) b(s)``."""
        number = self.flat.actions.index(self.flat.model.action(action))
        moved = np.asarray(self.flat.onward[number] @ self.vector)
        return replace(self, vector=moved, steps=self.steps + 1, action=number)

    def condition(self, observation: Any = None, known: Mapping[str, Value] | None = None) -> FlatBelief:
        """The posterior; observation variables that are left out, and known ones that are ``None``, say nothing."""
        seen = self.flat.model.observed(observation) if observation is not None else {}
        weights = self.vector
        if seen and self.action is not None:
            weights = weights * self._likelihood(self.action, seen)
        for name, value in (known or {}).items():
            if value is not None:
                weights = weights * self.flat.has_value(name, value)
        total = weights.sum()
        if not total > 0:
            names = [variable.name for variable in self.flat.model.states]
            raise ImpossibleObservation(names, self.flat.actions[self.action or 0], {**seen, **(known or {})})
        return replace(self, vector=weights / total)._running()

    def _running(self) -> FlatBelief:
        if self.flat.running is None:
            return self
        going_on = np.where(self.flat.running, self.vector, 0.0)
        total = going_on.sum()
        if not total > 0:
            names = [variable.name for variable in self.flat.model.states]
            raise ImpossibleObservation(names, self.flat.actions[self.action or 0], {GOES_ON.name: True})
        return replace(self, vector=going_on / total)

    def marginal(self, name: str) -> Float[np.ndarray, " values"]:
        """Probabilities of one state variable's values."""
        position = [variable.name for variable in self.flat.model.states].index(name)
        shape = [variable.size for variable in self.flat.model.states]
        index = np.unravel_index(self.flat.order, shape)[position]
        return np.bincount(index, self.vector, minlength=shape[position])

    def _likelihood(self, action: int, seen: Mapping[str, Value]) -> Float[np.ndarray, " states"]:
        names = [variable.name for variable in self.flat.model.observations]
        if len(seen) == len(names):
            columns, column = (
                self.flat.observation_columns[action],
                self.flat.column[tuple(seen[name] for name in names)],
            )
            stored = slice(columns.indptr[column], columns.indptr[column + 1])
            likelihood = np.zeros(self.flat.size)
            likelihood[columns.indices[stored]] = columns.data[stored]
            return likelihood
        fits = [all(o[name] == value for name, value in seen.items()) for o in self.flat.observations]
        return np.asarray(self.flat.observation[action] @ np.array(fits, dtype=float))


def vector_of(flat: FlatModel, belief: Any) -> Float[np.ndarray, " states"]:
    """A belief in the flat model's order.

    Parameters
    ----------
    belief : FlatBelief, JointBelief, ProductBelief, or (N,) array
        An array is over joint states, row-major in the model's variables.

    Raises
    ------
    ValueError
        Where an array is not a distribution over the model's joint states.
    """
    if isinstance(belief, FlatBelief):
        return belief.vector
    if isinstance(belief, ProductBelief):
        belief = joint_of(belief)
    if isinstance(belief, JointBelief):
        shape = [variable.size for variable in flat.model.states]
        array = np.broadcast_to(belief.table.dense().array_over(flat.model.states), shape).ravel()
    else:
        array = np.asarray(belief, dtype=float)
    if array.shape != (flat.size,) or (array < 0).any() or abs(array.sum() - 1) > 1e-6:
        raise ValueError(
            f"a belief of shape {array.shape} with sum {array.sum():.6g}: expected probabilities of the {flat.size:,} "
            f"joint states of {flat.model.name}"
        )
    return array[flat.order]
