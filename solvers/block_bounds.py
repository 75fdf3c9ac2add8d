"""A proved upper bound for models that are too large to flatten: every block for itself, with all actions to itself.

Where a model decomposes, rewards are a sum over blocks, and a block's states and observations depend on the others only
through the actions. Were each block free to choose all actions for itself alone, it would earn no less than under any
joint policy: so ``V ≤ Σ_k V_k`` with V_k the optimal value of block k with the known variables that it reads. The
block's value is bounded by the point-based search (with a horizon: by the fast informed bound), or, where even the
block is too large to flatten, by its largest reward in every step. Rewards of known variables and actions alone are
bounded this last way. Where a model has terminal states, a block's rewards end with the episode, which is not up to it:
then every part is bounded this last way, and by nothing where all its rewards are costs.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from factored_pomdp.beliefs.plan import plan_of
from factored_pomdp.errors import ModelError
from factored_pomdp.factors import Factor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import Block
from solvers.flat import can_flatten
from solvers.point_based import PointBased
from solvers.solution import Limits
from solvers.upper_bounds import FIB

__all__ = ["block_bound", "block_model"]


def block_bound(
    model: FactoredPOMDP, horizon: int | None, seconds: float | None = None
) -> tuple[float, tuple[str, ...]]:
    """The bound at the initial belief, and how each block's part was found.

    Parameters
    ----------
    seconds : float, optional
        For all blocks together; a second each if left out.
    """
    structure = plan_of(model).structure
    steps = float(horizon) if model.discount >= 1 and horizon is not None else _steps(model.discount, horizon)
    total = steps * sum(_largest(model, reward) for _, reward in structure.free_rewards)
    notes: dict[str, int] = {}
    share = 1.0 if seconds is None else max(seconds, 1e-3) / max(1, len(structure.blocks))
    for block in structure.blocks:
        part, how = _bound_of(model, block, Limits(horizon=horizon, time_limit=share), steps)
        total += part
        notes[how] = notes.get(how, 0) + 1
    return total, tuple(f"{number} block(s) bounded by {how}" for how, number in notes.items())


def block_model(model: FactoredPOMDP, block: Block) -> FactoredPOMDP | None:
    """A block with the known variables that it depends on, as a model of its own.

    ``None`` where a known variable that it depends on is moved by another block's hidden variables.
    """
    structure = plan_of(model).structure
    inside = set(block.names)
    tables = [*block.transition.values(), *block.likelihood.values(), *(reward for _, reward in block.rewards)]
    waiting = list(_states(model, tables))
    while waiting:
        name = waiting.pop()
        if name not in inside:
            inside.add(name)
            waiting += _states(model, [model.transition[name], model.initial[name]])
    if not inside <= set(block.names) | set(structure.known):
        return None
    seen = [variable for variable in model.observations if _states(model, [model.observation[variable.name]]) <= inside]
    tables += [model.transition[name] for name in inside] + [model.observation[v.name] for v in seen]
    read = {variable.name for table in tables for variable in table.scope}
    try:
        return FactoredPOMDP(
            name=f"{model.name}: {', '.join(block.names)}",
            states=[variable for variable in model.states if variable.name in inside],
            actions=[v for v in model.actions if v.name in read] or model.actions[:1],
            observations=seen,
            transition={name: model.transition[name] for name in inside},
            observation={variable.name: model.observation[variable.name] for variable in seen},
            reward=dict(block.rewards),
            initial={name: model.initial[name] for name in inside},
            discount=model.discount,
            known=model.declared_known & inside,
        )
    except ModelError:
        return None


def _bound_of(model: FactoredPOMDP, block: Block, limits: Limits, steps: float) -> tuple[float, str]:
    simple = steps * sum(_largest(model, reward) for _, reward in block.rewards)
    alone = block_model(model, block) if model.terminal is None else None
    if alone is None or not can_flatten(alone):
        return simple, "its largest reward in every step"
    if limits.horizon is None:
        return min(simple, PointBased(alone).solve(limits).upper), "point-based search on it alone"
    return min(simple, FIB(alone).solve(limits).upper), "the fast informed bound"


def _states(model: FactoredPOMDP, tables: Iterable[Factor]) -> set[str]:
    """State variables that tables read, in either slice."""
    states = {variable.name for variable in model.states}
    return {variable.name.removesuffix(".next") for table in tables for variable in table.scope} & states


def _steps(discount: float, horizon: int | None) -> float:
    """``1 + γ + γ² + …``."""
    if horizon is None:
        return 1 / (1 - discount)
    return (1 - discount**horizon) / (1 - discount)


def _largest(model: FactoredPOMDP, reward: Factor) -> float:
    nothing_is_possible = reward.stored < reward.size or model.terminal is not None
    return float(np.max(reward.sparse().numbers, initial=0.0 if nothing_is_possible else -np.inf))
