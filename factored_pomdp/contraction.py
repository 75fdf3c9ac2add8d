"""Sums of products of factors, by variable elimination.

Source: R. Dechter, "Bucket elimination", Artificial Intelligence 113 (1999). The order is greedy: the variable whose
elimination makes the smallest table goes first.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

from factored_pomdp.factors import Factor, constant
from factored_pomdp.factors.base import union
from factored_pomdp.variables import Variable, count

__all__ = ["contract"]


def contract(factors: Iterable[Factor], keep: Iterable[Variable]) -> Factor:
    """The product of the factors, summed over every variable that is not kept.

    Parameters
    ----------
    factors : iterable of Factor
    keep : iterable of Variable
        Those that occur in no factor are left out of the result's scope.
    """
    kept = set(keep)
    left = list(factors)
    while hidden := [variable for variable in union(*(f.scope for f in left)) if variable not in kept]:
        variable = min(hidden, key=lambda candidate: _cost(candidate, left))
        touching = [factor for factor in left if variable in factor.scope]
        touching.sort(key=lambda factor: factor.stored)
        left = [factor for factor in left if variable not in factor.scope]
        left.append(reduce(lambda a, b: a.product(b), touching).marginalise(variable))
    return reduce(lambda a, b: a.product(b), left, constant(1.0))


def _cost(variable: Variable, factors: list[Factor]) -> int:
    touching = [factor.scope for factor in factors if variable in factor.scope]
    return count(union(*touching)) // variable.size
