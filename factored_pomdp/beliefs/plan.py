"""What a product belief needs of a model, compiled once a model."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from jaxtyping import Int

from factored_pomdp.beliefs.likelihood import Likelihood, likelihood_of
from factored_pomdp.beliefs.prediction import Prediction
from factored_pomdp.beliefs.stacks import Stack, stacks_of
from factored_pomdp.factors.sparse import unflatten
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import GOES_ON, Structure, structure_of
from factored_pomdp.variables import Value, Variable, count

__all__ = ["Plan", "Seen", "StackPlan", "plan_of"]


@dataclass(frozen=True, eq=False)
class Seen:
    """One thing that is seen of a stack's blocks.

    Attributes
    ----------
    child : Variable
        An observation variable of the pattern (or `GOES_ON`), or the next value of a known variable.
    name : str
        The observation's or the known variable's name in the pattern.
    likelihood : Likelihood
    context : (states,) int
        Row of the likelihood's columns for every joint value of the pattern's variables.
    early : bool
        Whether it tells of their values before the step (a known variable may be moved by a hidden one).
    """

    child: Variable
    name: str
    likelihood: Likelihood
    context: Int[np.ndarray, " states"]
    early: bool


@dataclass(frozen=True, eq=False)
class StackPlan:
    """A stack with its compiled prediction and likelihoods."""

    stack: Stack
    prediction: Prediction
    seen: tuple[Seen, ...]

    @property
    def variables(self) -> tuple[Variable, ...]:
        return self.stack.pattern.variables

    @cached_property
    def shape(self) -> tuple[int, ...]:
        return tuple(variable.size for variable in self.variables)


@dataclass(frozen=True, eq=False)
class Plan:
    """Structure and stacks of a model, and the known values' moves that were worked out so far."""

    structure: Structure
    stacks: tuple[StackPlan, ...]
    moves: dict[tuple[object, ...], dict[str, Value]] = field(default_factory=dict)

    @cached_property
    def early(self) -> bool:
        """Whether something tells of the values before a step."""
        return any(seen.early for plan in self.stacks for seen in plan.seen)

    @cached_property
    def unhidden(self) -> frozenset[str]:
        """Observation variables that no hidden variable influences."""
        return frozenset(self.structure.laws.keys() & {v.name for v in self.structure.model.observations})


def plan_of(model: FactoredPOMDP) -> Plan:
    """The model's plan, made on first use."""
    if "plan" not in model.derived:
        structure = structure_of(model)
        observations = {GOES_ON.name, *(variable.name for variable in model.observations)}
        stacks = tuple(_stack_plan(stack, observations) for stack in stacks_of(structure.blocks))
        model.derived["plan"] = Plan(structure, stacks)
    plan: Plan = model.derived["plan"]
    return plan


def _stack_plan(stack: Stack, observations: set[str]) -> StackPlan:
    now = stack.pattern.variables
    coordinates = unflatten(np.arange(count(now)), now)
    seen = []
    for name, factor in stack.pattern.likelihood.items():
        child = factor.variable(name if name in observations else f"{name}.next")
        early = any(variable in factor.scope for variable in now)
        axes = now if early else tuple(variable.next for variable in now)
        likelihood = likelihood_of(factor, child, axes)
        rows = np.zeros(len(coordinates), dtype=np.int64)
        for variable in likelihood.hidden:
            rows = rows * variable.size + coordinates[:, axes.index(variable)]
        seen.append(Seen(child, name, likelihood, rows, early))
    return StackPlan(stack, Prediction(stack.pattern), tuple(seen))
