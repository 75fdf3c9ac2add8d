"""The exponential view of a model: flat matrices over joint states, sized before they are made.

Joint states, actions and observations are numbered in row-major order of the model's variables. The matrices are what
solvers for flat models expect, and an oracle on small ones.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from factored_pomdp.contraction import contract
from factored_pomdp.errors import TooLarge
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value, Variable, count

__all__ = ["Joint", "branching", "estimate", "joint"]

MOST_BYTES = 4_000_000_000
"""What an expansion may take unless the caller says otherwise."""

_COPIES = 3
"""Tables that are held at the same time while two factors are multiplied."""


@dataclass(frozen=True, eq=False)
class Joint:
    """A flat model.

    Attributes
    ----------
    states : tuple of Variable
        Row-major: the last one's value changes fastest.
    actions, observations : list of dict
        Joint assignments, in the order of the matrices.
    transition : list of (N, N) scipy CSR arrays
        For each action ``P(s' | s)``, a row for each ``s``.
    observation : list of (N, Z) scipy CSR arrays
        For each action ``P(z | s')``, a row for each ``s'``.
    reward : (A, N) float
        Expected reward of a step, ``E[R | s, a]``.
    initial : (N,) float
    discount : float
    terminal : (N,) bool
        States that an episode ends on entering. Here they are absorbing, and what happens in them earns nothing.
    """

    states: tuple[Variable, ...]
    actions: list[dict[str, Value]]
    observations: list[dict[str, Value]]
    transition: list[Any]
    observation: list[Any]
    reward: Float[np.ndarray, "actions states"]
    initial: Float[np.ndarray, " states"]
    discount: float
    terminal: Bool[np.ndarray, " states"]


def joint(model: FactoredPOMDP, most_bytes: int = MOST_BYTES) -> Joint:
    """Expand a model.

    Parameters
    ----------
    most_bytes : int
        What the expansion may take.

    Raises
    ------
    TooLarge
        With the sizes and the estimated bytes, before anything is allocated.
    """
    needed = estimate(model)
    if needed > most_bytes:
        raise TooLarge(
            f"joint expansion of {model.name}: {model.joint_states:,} joint states, {model.joint_actions:,} joint "
            f"actions, {model.joint_observations:,} joint observations: up to {needed:,} bytes; {most_bytes:,} allowed"
        )
    states, after = model.states, tuple(variable.next for variable in model.states)
    actions, observations = _assignments(model.actions), _assignments(model.observations)
    transition = [_matrix(model.transition.values(), action, states, after) for action in actions]
    observation = [_matrix(model.observation.values(), action, after, model.observations) for action in actions]
    reward = np.stack([_expected_reward(model, action) for action in actions])
    terminal = np.zeros(model.joint_states, dtype=bool)
    if model.terminal is not None:
        terminal = _laid_out(model.terminal, states) != 0
        transition = [_absorbing(matrix, terminal) for matrix in transition]
        reward[:, terminal] = 0.0
    initial = _laid_out(contract(model.initial.values(), states), states)
    return Joint(
        states, actions, observations, transition, observation, reward, initial, float(model.discount), terminal
    )


def estimate(model: FactoredPOMDP) -> int:
    """Bytes that `joint` may take at the most: matrices of all actions, and the largest product on the way."""
    moves = model.joint_states * math.prod(branching(f, f"{x}.next") for x, f in model.transition.items())
    views = model.joint_states * math.prod(branching(f, o) for o, f in model.observation.items())
    stored = 12 * (moves + views) + 16 * model.joint_states
    entry = 8 * (len(model.states) + max(len(model.states), len(model.observations)) + 1)
    return model.joint_actions * stored + _COPIES * entry * max(moves, views) + 100 * model.joint_observations


def branching(factor: Factor, child: str) -> int:
    """The largest number of values of the child that are possible at any one assignment of its parents."""
    variable = factor.variable(child)
    if isinstance(factor, DeterministicFactor) and factor.child == variable:
        return 1
    if isinstance(factor, NoisyOr):
        shown = (int(np.diff(cause.emission.tocsr().indptr).max(initial=0)) for cause in factor.causes)
        return min(variable.size, 1 + sum(shown))
    if isinstance(factor, SparseFactor):
        lines = factor.flat(other for other in factor.scope if other != variable)
        return int(np.unique(lines, return_counts=True)[1].max(initial=1))
    table = factor.dense()
    return int((table.array > 0).sum(axis=table.scope.index(variable)).max())


def _matrix(
    factors: Iterable[Factor], action: Mapping[str, Value], rows: tuple[Variable, ...], columns: tuple[Variable, ...]
) -> Any:
    """The product of conditional distributions at one action, as a CSR array."""
    from scipy import sparse

    ones = DenseFactor(rows, np.ones([variable.size for variable in rows])).sparse()
    # Children come after their parents of the same slice: then no product holds more entries than the result may.
    product = reduce(lambda table, factor: table.join(factor), _parents_first(factors, action, columns), ones)
    shape = (count(rows), count(columns))
    return sparse.csr_array((product.numbers, (product.flat(rows), product.flat(columns))), shape=shape)


def _parents_first(
    factors: Iterable[Factor], action: Mapping[str, Value], children: tuple[Variable, ...]
) -> list[SparseFactor]:
    left = dict(zip(children, factors, strict=True))
    ordered = []
    while left:
        child = next(c for c, factor in left.items() if not any(v in left for v in factor.scope if v != c))
        ordered.append(left.pop(child).condition(action).sparse())
    return ordered


def _absorbing(matrix: Any, terminal: Bool[np.ndarray, " states"]) -> Any:
    """The same matrix with each terminal state leading to itself."""
    from scipy import sparse

    ends = sparse.diags_array(terminal.astype(float))
    stays = sparse.diags_array((~terminal).astype(float))
    absorbing = sparse.csr_array(stays @ matrix + ends)
    absorbing.eliminate_zeros()
    return absorbing


def _expected_reward(model: FactoredPOMDP, action: Mapping[str, Value]) -> Float[np.ndarray, " states"]:
    total = np.zeros(model.joint_states)
    for reward in model.reward.values():
        factors = [reward, *_ancestors(model, reward)]
        expected = contract([factor.condition(action) for factor in factors], model.states)
        total += _laid_out(expected, model.states)
    return total


def _ancestors(model: FactoredPOMDP, reward: Factor) -> list[Factor]:
    """Distributions of the next states and observations that a reward reads, and of what those depend on."""
    distributions = model.observation | {f"{name}.next": factor for name, factor in model.transition.items()}
    found: dict[str, Factor] = {}
    waiting = list(reward.names)
    while waiting:
        name = waiting.pop()
        if name in distributions and name not in found:
            found[name] = distributions[name]
            waiting += found[name].names
    return list(found.values())


def _laid_out(factor: Factor, states: tuple[Variable, ...]) -> Float[np.ndarray, " states"]:
    shape = [variable.size for variable in states]
    return np.broadcast_to(factor.array_over(states), shape).ravel()


def _assignments(variables: tuple[Variable, ...]) -> list[dict[str, Value]]:
    names = [variable.name for variable in variables]
    combinations = itertools.product(*(variable.values for variable in variables))
    return [dict(zip(names, values, strict=True)) for values in combinations]
