"""Policies made of alpha vectors and upper bounds; every decision carries both bounds."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from jaxtyping import Bool, Float

from solvers.action_values import Valued, one_step_values
from solvers.alpha_vectors import VectorSet
from solvers.base import Decision
from solvers.flat import FlatModel
from solvers.flat_belief import FlatBelief, vector_of
from solvers.sawtooth import Sawtooth

__all__ = ["Follows", "Stage", "VectorPolicy"]

Follows = Literal["lower bound", "upper bound", "most probable state"]
"""What a policy maximises."""


@dataclass(frozen=True, eq=False)
class Stage:
    """Both bounds with a number of steps to go.

    Attributes
    ----------
    lower : VectorSet
    upper : (A, N) float or None
        ``max_a α_a · b`` is no less than the value; minus infinity where an action is not legal. ``None`` where the
        lower bound is exact.
    sawtooth : Sawtooth or None
        A tighter upper bound.
    per_state : bool
        Whether the upper bound is ``Σ_s b(s) max_a α_a(s)``.
    """

    lower: VectorSet
    upper: Float[np.ndarray, "actions states"] | None
    sawtooth: Sawtooth | None = None
    per_state: bool = False


@dataclass(frozen=True, eq=False)
class VectorPolicy:
    """Chooses by alpha vectors, or by what bounds the value from above.

    Attributes
    ----------
    flat : FlatModel
    solver : str
        Name of the solver that made it.
    stages : tuple of Stage
        The n-th for n + 1 steps to go; only one where the horizon is infinite.
    follows : str
    horizon : int or None
    """

    flat: FlatModel
    solver: str
    stages: tuple[Stage, ...]
    follows: Follows
    horizon: int | None = None

    @property
    def points(self) -> int:
        """Belief points of the upper bound."""
        return sum(len(stage.sawtooth) for stage in self.stages if stage.sawtooth is not None)

    def start(self) -> FlatBelief:
        """The initial belief, in the quickest form that `decide` takes."""
        return FlatBelief.initial(self.flat)

    def stage(self, steps_to_go: int | None = None) -> Stage:
        """The stage for a number of steps to go; the last (the horizon's, or the only one) without."""
        if self.horizon is None or steps_to_go is None:
            return self.stages[-1]
        return self.stages[min(max(steps_to_go, 1), len(self.stages)) - 1]

    def decide(self, belief: Any, steps_to_go: int | None = None) -> Decision:
        """An action, what the policy earns at the least from here, and what none can exceed.

        Parameters
        ----------
        belief : FlatBelief, JointBelief, ProductBelief or (N,) array
        steps_to_go : int, optional
            With a finite horizon; a `FlatBelief` counts its steps itself.
        """
        vector, stage = vector_of(self.flat, belief), self.stage(self._steps_to_go(belief, steps_to_go))
        lower, action = self._lower(stage, vector)
        upper = max(lower, self._upper(stage, vector, lower))
        if self.follows != "lower bound":
            action = self._followed(stage, vector)
        found = f"{self.solver}, following its {self.follows}"
        proved = upper - lower <= 1e-9 * max(1.0, abs(lower)) and self.follows == "lower bound"
        return Decision(self.flat.actions[action], lower, upper, found if proved else f"{found}; not proved")

    def values(self, belief: Any, steps_to_go: int | None = None) -> Valued:
        """Every legal action and what it is worth.

        Where the policy follows its lower bound: the expected reward of a step, and the lower bound from there on; else
        the numbers that it compares.
        """
        steps_to_go = self._steps_to_go(belief, steps_to_go)
        vector, legal = vector_of(self.flat, belief), self._legal_at(vector_of(self.flat, belief))
        if self.follows != "lower bound":
            worth = self._compared(self.stage(steps_to_go), vector)
            return [(self.flat.actions[number], float(worth[number])) for number in np.flatnonzero(legal)]
        if self.horizon is None:
            after = self.stages[-1]
        elif (left := len(self.stages) if steps_to_go is None else steps_to_go) > 1:
            after = self.stage(left - 1)
        else:
            return one_step_values(self.flat, vector, legal, None)
        return one_step_values(self.flat, vector, legal, lambda belief: self._lower(after, belief)[0])

    def _steps_to_go(self, belief: Any, steps_to_go: int | None) -> int | None:
        if steps_to_go is None and self.horizon is not None and isinstance(belief, FlatBelief):
            return self.horizon - belief.steps
        return steps_to_go

    def bounds(self, belief: Float[np.ndarray, " states"]) -> tuple[float, float]:
        """Lower and upper bound at a belief in the flat model's order, at the horizon."""
        lower, _ = self._lower(self.stages[-1], belief)
        return lower, max(lower, self._upper(self.stages[-1], belief, lower))

    def _lower(self, stage: Stage, belief: Float[np.ndarray, " states"]) -> tuple[float, int]:
        number = self.flat.class_at(belief)
        if number is not None and stage.lower.has(number):
            return stage.lower.best(belief, number)
        floor = self._floor if self.horizon is None else self._floor_of_a_step * len(self.stages)
        return floor, int(self._legal_at(belief).argmax())

    def _upper(self, stage: Stage, belief: Float[np.ndarray, " states"], lower: float) -> float:
        if stage.upper is None:
            number = self.flat.class_at(belief)
            return lower if number is not None and stage.lower.has(number) else np.inf
        support = np.flatnonzero(belief)
        if stage.per_state:
            return float(stage.upper[:, support].max(axis=0) @ belief[support])
        found = float((stage.upper[:, support] @ belief[support]).max())
        number = self.flat.class_at(belief)
        if stage.sawtooth is not None and number is not None:
            found = min(found, stage.sawtooth.at(belief, number))
        return found

    def _followed(self, stage: Stage, belief: Float[np.ndarray, " states"]) -> int:
        return int(np.where(self._legal_at(belief), self._compared(stage, belief), -np.inf).argmax())

    def _compared(self, stage: Stage, belief: Float[np.ndarray, " states"]) -> Float[np.ndarray, " actions"]:
        """What the policy compares where it follows its upper bound."""
        upper = stage.upper
        if upper is None:
            raise ValueError(f"a policy of {self.solver} has no upper bound to follow")
        if self.follows == "most probable state":
            return upper[:, int(belief.argmax())]
        support = np.flatnonzero(belief)
        return np.asarray(upper[:, support] @ belief[support])

    def _legal_at(self, belief: Float[np.ndarray, " states"]) -> Bool[np.ndarray, " actions"]:
        """Which actions are legal wherever the belief has mass."""
        return np.asarray(self.flat.tables.legal[:, belief > 0].all(axis=1))

    @cached_property
    def _floor_of_a_step(self) -> float:
        return float(self.flat.reward[self.flat.tables.legal].min())

    @cached_property
    def _floor(self) -> float:
        """What any policy earns at the least: no vector is about beliefs that the model cannot lead to."""
        return self._floor_of_a_step / (1 - self.flat.discount)
