"""Beliefs: joint (exact, exponential) and product (a stack of arrays)."""

from __future__ import annotations

import numpy as np

from factored_pomdp.beliefs.joint import JointBelief
from factored_pomdp.beliefs.plan import plan_of
from factored_pomdp.beliefs.product import ProductBelief
from factored_pomdp.beliefs.roster import Roster
from factored_pomdp.contraction import contract_ancestors
from factored_pomdp.model import FactoredPOMDP

__all__ = ["JointBelief", "ProductBelief", "initial_belief"]


def initial_belief(model: FactoredPOMDP, project: bool = False) -> ProductBelief:
    """The model's initial belief as a product over blocks, given that the episode does not end at once.

    Parameters
    ----------
    project : bool
        Keep tied things apart after every step by projecting onto their marginals (Boyen and Koller, UAI 1998); the
        belief then says that it is not exact.
    """
    plan = plan_of(model)
    known = {name: _certain(model, name) for name in plan.structure.known}
    arrays = []
    for stack in plan.stacks:
        columns = []
        for names in stack.stack.names:
            scope = [model.variable(names[variable.name]) for variable in stack.variables]
            columns.append(_start(model, [variable.name for variable in scope]).ravel())
        arrays.append(np.ascontiguousarray(np.stack(columns, axis=1)))
    roster = Roster(plan, tuple(stack.stack.names for stack in plan.stacks))
    belief = ProductBelief(plan, known, tuple(arrays), roster, project=project).running()
    return belief._projected() if project else belief


def _certain(model: FactoredPOMDP, name: str) -> object:
    return model.variable(name).values[int(_start(model, [name]).argmax())]


def _start(model: FactoredPOMDP, names: list[str]) -> np.ndarray:
    """Initial probabilities of some state variables."""
    scope = [model.variable(name) for name in names]
    return contract_ancestors(model.initial, scope).array_over(scope)
