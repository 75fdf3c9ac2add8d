"""Choosing the joint action that maximises a sum of local functions.

``maximise`` enumerates while that is cheap (up to 100,000 joint actions) and is greedy beyond, with a bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

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
        Values to keep where that costs nothing; among other equals the first action is taken.
    """
    narrowed = list(functions)
    choices: list[Variable] = []
    forced: dict[str, Value] = {}
    for variable in actions:
        rules = [rule for rule in legal if variable in rule.scope] if legal else []
        values = (
            [v for v in variable.values if all(rule.value({variable.name: v}) for rule in rules)]
            if rules
            else (variable.values)
        )
        if not values:
            raise ValueError(f"no value of {variable.name!r} is legal")
        if len(values) == 1:
            forced[variable.name] = values[0]
            continue
        choices.append(variable if len(values) == variable.size else Variable(variable.name, values))
        if choices[-1] is not variable:
            indexes = np.array([variable.index(value) for value in values])
            narrowed = [f.substituted(variable, choices[-1], indexes) if variable in f.scope else f for f in narrowed]
    if forced:
        narrowed = [f.condition(forced) if forced.keys() & set(f.names) else f for f in narrowed]
    choose = enumerate_all if count(choices) <= ENUMERATED else greedy_with_swaps
    found = choose(narrowed, choices, prefer or {})
    if forced:
        return replace(found, action={v.name: forced.get(v.name, found.action.get(v.name)) for v in actions})
    return found
