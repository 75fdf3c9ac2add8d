"""Choosing the joint action that maximises a sum of local functions.

``maximise`` enumerates while that is cheap (up to 100,000 joint actions) and is greedy beyond, with a bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from factored_pomdp.factors import Factor
from factored_pomdp.variables import Value, Variable, count
from solvers.base import Decision
from solvers.maximise.enumeration import enumerate_all
from solvers.maximise.greedy import greedy_with_swaps

__all__ = ["ENUMERATED", "maximise"]

ENUMERATED = 100_000
"""Joint actions up to which every one is looked at."""


def maximise(
    functions: Sequence[Factor],
    actions: Sequence[Variable],
    legal: Sequence[Factor] = (),
    prefer: Mapping[str, Value] | None = None,
) -> Decision:
    """The joint action with the largest sum of local functions.

    Parameters
    ----------
    functions : sequence of Factor
        Over action variables only.
    actions : sequence of Variable
        All that must be given a value.
    legal : sequence of Factor
        Over one action variable each: zero where its value may not be chosen.
    prefer : mapping, optional
        Values to keep where that costs nothing; among other equals the first value is taken.
    """
    allowed, ordered = [], []
    for variable in actions:
        values = [v for v in variable.values if all(f.value({variable.name: v}) for f in legal if variable in f.scope)]
        if prefer is not None and prefer.get(variable.name) in values:
            values.sort(key=lambda value: value != prefer[variable.name])
        ordered.append(Variable(variable.name, values))
        allowed.append([variable.index(value) for value in values])
    narrowed = []
    for function in functions:
        for variable, new, indexes in zip(actions, ordered, allowed, strict=True):
            if variable in function.scope and new != variable:
                function = function.substituted(variable, new, _array(indexes))
        narrowed.append(function)
    if count(ordered) <= ENUMERATED:
        return enumerate_all(narrowed, ordered)
    return greedy_with_swaps(narrowed, ordered)


def _array(indexes: list[int]) -> object:
    import numpy as np

    return np.array(indexes)
