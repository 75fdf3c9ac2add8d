"""Sums of products of factors, by variable elimination.

Source: R. Dechter, "Bucket elimination", Artificial Intelligence 113 (1999). The order is greedy: the variable whose
elimination makes the smallest table goes first.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import reduce

from factored_pomdp.factors import Factor, constant
from factored_pomdp.factors.base import union
from factored_pomdp.variables import Variable, count

__all__ = ["contract", "contract_ancestors"]


def contract(factors: Iterable[Factor], keep: Iterable[Variable]) -> Factor:
    """The product of the factors, summed over every variable that is not kept.

    Parameters
    ----------
    factors : iterable of Factor
    keep : iterable of Variable
        Those that occur in no factor are left out of the result's scope.
    """
    kept = set(keep)
    left: list[Factor] = list(factors)
    while hidden := [variable for variable in union(*(f.scope for f in left)) if variable not in kept]:
        variable = min(hidden, key=lambda candidate: _cost(candidate, left))
        touching = [factor for factor in left if variable in factor.scope]
        touching.sort(key=lambda factor: factor.stored)
        left = [factor for factor in left if variable not in factor.scope]
        left.append(reduce(lambda a, b: a.product(b), touching).marginalise(variable))
    nothing: Factor = constant(1.0)
    return reduce(lambda a, b: a.product(b), left, nothing)


def contract_ancestors(distributions: Mapping[str, Factor], keep: Iterable[Variable]) -> Factor:
    """Joint distribution of some variables, from their distributions (by name) and those that they depend on."""
    kept = list(keep)
    needed: dict[str, Factor] = {}
    waiting = [variable.name for variable in kept]
    while waiting:
        name = waiting.pop()
        if name not in needed:
            needed[name] = distributions[name]
            waiting += [variable.name for variable in distributions[name].scope]
    return contract(needed.values(), kept)


def _cost(variable: Variable, factors: list[Factor]) -> int:
    touching = [factor.scope for factor in factors if variable in factor.scope]
    return count(union(*touching)) // variable.size
