"""A product belief beside a joint one: multiplied out, drawn at random, sampled from, and compared in numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from factored_pomdp.beliefs import initial_belief
from factored_pomdp.beliefs.joint import JointBelief
from factored_pomdp.beliefs.product import ProductBelief
from factored_pomdp.factors import DenseFactor, Factor, SparseFactor, constant
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value, Variable

__all__ = ["Comparison", "Gap", "joint_of", "random_product_belief", "sampled_state", "spelled_out"]


@dataclass(frozen=True)
class Gap:
    """Two probabilities of the same thing."""

    at: str
    joint: float
    product: float


@dataclass(frozen=True, eq=False)
class Comparison:
    """Where the two beliefs are farthest apart.

    Attributes
    ----------
    states : Gap
        Over joint states: the joint probability against the product of the blocks'.
    blocks : tuple of Gap
        For each block its marginal of the joint belief against its own probabilities.
    outside : Gap
        Mass that the joint belief (all of it: one) and the product give to the joint belief's support.
    """

    states: Gap
    blocks: tuple[Gap, ...]
    outside: Gap

    @classmethod
    def of(cls, joint: JointBelief, product: ProductBelief) -> Comparison:
        """Compare; cost: one pass over the joint states with mass, for each block."""
        support = joint.table.sparse()
        multiplied = SparseFactor(support.scope, support.coordinates, np.ones(support.stored))
        numbers = multiplied.numbers
        for part in _parts(product):
            columns = tuple(support.coordinates[:, support.scope.index(variable)] for variable in part.scope)
            numbers = numbers * part.array[columns]
        worst = int(np.abs(support.numbers - numbers).argmax())
        at = _at(support.scope, support.coordinates[worst])
        states = Gap(at, float(support.numbers[worst]), float(numbers[worst]))
        blocks = tuple(_block_gap(joint, product.block(names[0])) for names in product.blocks)
        return cls(states, blocks, Gap("support of the joint belief", 1.0, float(numbers.sum())))

    def worst(self) -> Gap:
        """The largest gap of all."""
        return max((self.states, *self.blocks, self.outside), key=lambda gap: abs(gap.joint - gap.product))


def joint_of(product: ProductBelief, sparse: bool = False) -> JointBelief:
    """The same belief over joint states."""
    table: Factor = constant(1.0).sparse() if sparse else constant(1.0)
    for part in _parts(product):
        table = table.product(part.sparse() if sparse else part)
    return JointBelief(product.plan.structure.model, table, sparse)


def random_product_belief(model: FactoredPOMDP, state: Mapping[str, Value], rng: np.random.Generator) -> ProductBelief:
    """A belief whose blocks are drawn dense, sparse or certain, and whose known variables are as in ``state``.

    No terminal state has mass; ``state`` is not terminal.
    """
    start = initial_belief(model)
    known = {name: state[name] for name in start.known}
    possible = start.with_arrays([np.full(array.shape, 1 / len(array)) for array in start.arrays], known).running()
    arrays = []
    for array in possible.arrays:
        columns = [_random_column(array[:, column] > 0, rng) for column in range(array.shape[1])]
        arrays.append(np.stack(columns, axis=1) if columns else array)
    return start.with_arrays(arrays, known)


def sampled_state(product: ProductBelief, rng: np.random.Generator) -> dict[str, Value]:
    """A joint state drawn from a product belief."""
    state = dict(product.known)
    for names in product.blocks:
        table = product.block(names[0])
        flat = rng.choice(table.array.size, p=table.array.ravel() / table.array.sum())
        index = np.unravel_index(flat, table.array.shape)
        state |= {variable.name: variable.values[int(i)] for variable, i in zip(table.scope, index, strict=True)}
    return state


def spelled_out(product: ProductBelief) -> dict[str, Any]:
    """The whole belief: known values, and for each block the probability of every value that has any."""
    listed: dict[str, Any] = dict(product.known)
    for names in product.blocks:
        table = product.block(names[0]).sparse()
        rows = zip(table.coordinates, table.numbers, strict=True)
        listed[", ".join(names)] = {_at(table.scope, row): float(number) for row, number in rows}
    return listed


def _parts(product: ProductBelief) -> list[DenseFactor]:
    model = product.plan.structure.model
    known = [model.variable(name) for name in product.known]
    certain = [DenseFactor([v], [float(value == product.known[v.name]) for value in v.values]) for v in known]
    return [*certain, *(product.block(names[0]) for names in product.blocks)]


def _random_column(possible: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    at = np.flatnonzero(possible)
    support = (1, int(rng.integers(1, len(at) + 1)), len(at))[int(rng.integers(3))]
    column = np.zeros(len(possible))
    column[at[rng.choice(len(at), support, replace=False)]] = rng.dirichlet(np.ones(support))
    return column


def _block_gap(joint: JointBelief, block: DenseFactor) -> Gap:
    marginal = joint.marginal(*block.names).array
    index = np.unravel_index(int(np.abs(marginal - block.array).argmax()), marginal.shape)
    return Gap(_at(block.scope, np.array(index)), float(marginal[index]), float(block.array[index]))


def _at(scope: tuple[Variable, ...], index: np.ndarray) -> str:
    return ", ".join(f"{variable.name}={variable.values[int(i)]}" for variable, i in zip(scope, index, strict=True))
