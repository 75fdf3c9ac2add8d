"""The prediction step of a stack, compiled into sparse operators that are applied one after the other.

A block's transition is a product of conditional distributions. Multiplying them into the belief one at a time, and
summing every current variable out once nothing reads it any more, is variable elimination with the belief in hand;
for a target with place, heading and speed it comes to heading, speed, place: a fraction of one flattened matrix's cost.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from factored_pomdp.beliefs.operator import Operator
from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.structure import Block
from factored_pomdp.variables import Value, Variable, count

__all__ = ["Prediction", "apply_in_turn"]


class Prediction:
    """Predicts a stack's array; operators are compiled once for each assignment of the context that matters.

    Attributes
    ----------
    context : tuple of Variable
        Actions and known variables (of either slice) that the transitions read.
    """

    def __init__(self, block: Block) -> None:
        self.block = block
        inner = {v for variable in block.variables for v in (variable, variable.next)}
        scopes = [factor.scope for factor in block.transition.values()]
        self.context: tuple[Variable, ...] = tuple(dict.fromkeys(v for s in scopes for v in s if v not in inner))
        self._compiled: dict[tuple[Value, ...], list[Operator]] = {}

    def operators(self, assignment: Mapping[str, Value]) -> list[Operator]:
        """The operators to apply in turn, at one assignment of the context."""
        key = tuple(assignment[variable.name] for variable in self.context)
        if key not in self._compiled:
            self._compiled[key] = _compile(self.block, dict(zip((v.name for v in self.context), key, strict=True)))
        return self._compiled[key]

    def apply(self, array: np.ndarray, assignment: Mapping[str, Value]) -> np.ndarray:
        """Predicted (states, members) of current (states, members)."""
        return apply_in_turn(self.operators(assignment), array)


def apply_in_turn(operators: Sequence[Operator], array: np.ndarray) -> np.ndarray:
    """The product of some operators with (states, members), a few members at a time.

    What lies between two operators then stays in the cache, however many members there are.
    """
    from factored_pomdp.beliefs.kernels import apply_operator
    from factored_pomdp.beliefs.vectors import tiles

    if not operators:
        return array
    source, some = np.ascontiguousarray(array), tiles(array.shape[1])
    widest = max((tile.columns for tile in some), default=0)
    between = [np.empty((operator.states, widest)) for operator in operators[:-1]]
    result = np.empty((operators[-1].states, array.shape[1]))
    for tile in some:
        before, at = source, tile.first
        for operator, table in zip(operators, between, strict=False):
            apply_operator(operator, before, at, table, 0, tile)
            before, at = table, 0
        apply_operator(operators[-1], before, at, result, tile.first, tile)
    return result


def _compile(block: Block, assignment: Mapping[str, Value]) -> list[Operator]:
    rank = {v.name: 2 * n for n, v in enumerate(block.variables)} | {
        v.next.name: 2 * n + 1 for n, v in enumerate(block.variables)
    }
    left = {name: factor.condition(assignment) for name, factor in block.transition.items()}
    axes = list(block.variables)
    operators = []
    while left:
        ready = [name for name, factor in left.items() if _is_ready(factor, f"{name}.next", axes)]
        name = min(ready, key=lambda candidate: _entries(left[candidate], f"{candidate}.next", axes))
        factor = left.pop(name)
        needed = {variable.name for other in left.values() for variable in other.scope}
        after = [v for v in axes if v.name in needed or v.is_next] + [factor.variable(f"{name}.next")]
        after.sort(key=lambda variable: rank[variable.name])
        operator = _operator(factor, tuple(axes), tuple(after))
        if operator is not None:
            operators.append(operator)
        axes = after
    return operators


def _is_ready(factor: Factor, child: str, axes: list[Variable]) -> bool:
    return all(variable in axes or variable.name == child or not variable.is_next for variable in factor.scope)


def _entries(factor: Factor, child: str, axes: list[Variable]) -> int:
    bystanders = [variable for variable in axes if variable not in factor.scope]
    return factor.stored * count(bystanders)


def _operator(factor: Factor, before: tuple[Variable, ...], after: tuple[Variable, ...]) -> Operator | None:
    """Multiply by the factor and sum out what ``after`` lacks; ``None`` where that changes nothing."""
    from scipy import sparse

    if factor.size == 1 and count(before) == count(after):
        return None
    bystanders = [variable for variable in before if variable not in factor.scope]
    spread = DenseFactor(bystanders, np.ones([variable.size for variable in bystanders]))
    entries = factor.sparse().join(spread) if bystanders else factor.sparse()
    absent = [v for v in (*before, *after) if v not in entries.scope]
    if absent:
        entries = entries.join(SparseFactor(absent, np.zeros((1, len(absent))), [1.0]))
    rows, columns = entries.flat(after), entries.flat(before)
    matrix = sparse.csr_array((entries.numbers, (rows, columns)), shape=(count(after), count(before)))
    matrix.sum_duplicates()
    return Operator(matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data, count(after))
