"""What choosing step by step by simulation has in common: the myopic policy as its base, and leave to depart from it.

The myopic action stands unless another leads it by more than ``margin`` standard errors of their paired difference: as
far as sampling allows, the choice is never worse than the base. No value found this way is proved.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import count
from solvers.action_values import Valued
from solvers.base import Ability, Decision
from solvers.foresight.first_actions import FirstAction, first_actions
from solvers.foresight.returns import Returns
from solvers.foresight.scenarios import Scenarios
from solvers.myopic import DecomposedMyopic

__all__ = ["Online", "can_look_ahead"]


class Online(ABC):
    """Compares a few first actions by simulation.

    Subclasses say what their parameters mean; ``scenarios`` are simulated worlds for each first action.
    """

    def __init__(
        self,
        model: FactoredPOMDP,
        steps: int,
        scenarios: int,
        actions: int,
        margin: float,
        keep: Mapping[str, str] | None,
        rng: np.random.Generator | None,
    ) -> None:
        ability = self.can_solve(model)
        if not ability:
            raise ValueError(f"{ability.because}; {ability.estimate}")
        least = {"steps": (steps, 1), "scenarios": (scenarios, 2), "actions": (actions, 1), "margin": (margin, 0)}
        wrong = [f"{name} {given}: expected at least {low}" for name, (given, low) in least.items() if not given >= low]
        if wrong:
            raise ValueError("; ".join(wrong))
        self.model, self.steps, self.scenarios, self.actions, self.margin = model, steps, scenarios, actions, margin
        self.base = DecomposedMyopic(model)
        self._rng = rng if rng is not None else np.random.default_rng(0)
        self._simulated = Scenarios(self.base, keep or {})
        self._names = [variable.name for variable in model.states]
        self._last: tuple[ProductBelief, Valued] | None = None

    @classmethod
    @abstractmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where the myopic policy can; what a decision costs."""

    @abstractmethod
    def compared(self, belief: ProductBelief) -> Returns:
        """Sampled returns of first actions over all the steps, the myopic action first."""

    def start(self) -> ProductBelief:
        """The model's initial belief, in the form that `decide` takes."""
        return self.base.start()

    def decide(self, belief: ProductBelief) -> Decision:
        """The myopic action, or one that proved better in simulation; the value is that of all the steps.

        Where a known value could not be read, or blocks were added to the model's or taken away, nothing is simulated
        and the myopic choice for one step is given.
        """
        hindrance = self._hindrance(belief)
        if self.steps == 1 or hindrance:
            base = self.base.decide(belief, self._simulated.preferred(belief))
            return replace(base, method=f"{base.method}, one step ahead: {hindrance}") if hindrance else base
        found = self.compared(belief)
        self._last = belief, found.valued
        chosen = found.better_than_base(self.margin)
        method = f"{self._described(found)}, standard error {found.error(chosen):.3g}; not proved"
        return Decision(found.actions[chosen][0], found.mean(chosen), math.inf, method)

    def values(self, belief: ProductBelief) -> Valued:
        """Estimated returns of the first actions that were compared; one-step values where nothing is simulated.

        The last decision's own where it was made at this belief, so that asking changes nothing that comes later.
        """
        if self.steps == 1 or self._hindrance(belief):
            return self.base.values(belief)
        if self._last is not None and self._last[0] is belief:
            return self._last[1]
        return self.compared(belief).valued

    def first_actions(self, belief: ProductBelief) -> list[FirstAction]:
        """Which first actions are compared, the myopic one first."""
        base = self.base.decide(belief, self._simulated.preferred(belief))
        return first_actions(self.base, belief, base, self.actions)

    def _hindrance(self, belief: ProductBelief) -> str:
        """Why nothing can be simulated from a belief; empty where something can."""
        unread = sorted(name for name, value in belief.known.items() if value is None)
        if unread:
            return f"{unread[0]} was not read back"
        changed = belief.roster.places.keys() ^ (set(self._names) - belief.known.keys())
        return f"{min(changed)} is in the belief or in the model, but not in both" if changed else ""

    @abstractmethod
    def _described(self, found: Returns) -> str:
        """How the returns were found."""


def can_look_ahead(model: FactoredPOMDP, steps: int, beliefs: int) -> Ability:
    """Whether the myopic policy can be followed in simulated worlds, and what that costs.

    Parameters
    ----------
    steps : int
        Steps of the belief in a decision.
    beliefs : int
        How many beliefs are held at once.
    """
    ability = DecomposedMyopic.can_solve(model)
    if not ability:
        return ability
    numbers = sum(count(block.variables) for block in structure_of(model).blocks)
    estimate = f"up to {steps:,} steps of the belief a decision, {8 * numbers * beliefs:,} bytes"
    return Ability(True, ability.because, estimate)
