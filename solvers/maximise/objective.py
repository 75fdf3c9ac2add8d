"""A sum of local functions at a choice that grows and changes: what each value of one variable would make of it.

Coverage (a noisy-or expectation that pays the same whoever detects) keeps, for every context, what is still silent, so
that a look at one variable costs only the contexts that the variable reaches; other functions are evaluated anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from factored_pomdp.factors import ExpectedNoisyOr, Factor
from factored_pomdp.variables import Variable

__all__ = ["Objective"]

Choice = dict[str, int]


@runtime_checkable
class _Term(Protocol):
    def value(self) -> float:
        """At the choice so far; variables that have no value yet contribute nothing (tables: their least)."""

    def values(self, variable: Variable) -> np.ndarray:
        """The same for each value of one variable, the others as chosen."""

    def choose(self, name: str, index: int) -> None:
        """Give a variable a value."""

    def bound(self) -> float:
        """No choice is worth more; every variable has a value."""


class Objective:
    """The sum of some local functions.

    Attributes
    ----------
    choice : dict
        Position of the value of each variable that has one.
    """

    def __init__(self, functions: Sequence[Factor]) -> None:
        self.choice: Choice = {}
        self._terms: list[_Term] = [_term(function) for function in functions]
        self._scopes = [set(function.names) for function in functions]

    def value(self) -> float:
        return float(sum(term.value() for term in self._terms))

    def gains(self, variable: Variable) -> np.ndarray:
        """What each value of a variable would add, (values,); compared with no value where it has none."""
        gains = np.zeros(variable.size)
        for term, scope in zip(self._terms, self._scopes, strict=True):
            if variable.name in scope:
                gains += term.values(variable) - term.value()
        return gains

    def choose(self, variable: Variable, index: int) -> None:
        """Give a variable a value, or another one."""
        self.choice[variable.name] = index
        for term, scope in zip(self._terms, self._scopes, strict=True):
            if variable.name in scope:
                term.choose(variable.name, index)

    def bound(self) -> float:
        """An upper bound over all choices, from this one."""
        return float(sum(term.bound() for term in self._terms))


def _term(function: Factor) -> _Term:
    if isinstance(function, ExpectedNoisyOr) and len(function.scope) > 1:
        return _Coverage(function) if function.pays_once and function.causes else _Causes(function)
    return _Table(function)


class _Coverage:
    """``Σ w r − Σ_ctx w (r − r_off) ∏_i (1 − p_i)``, with the product kept up to date.

    Factors that are zero are counted, not multiplied, so that each can be taken out again.
    """

    def __init__(self, cover: ExpectedNoisyOr) -> None:
        payoff = cover.causes[0].payoff
        self._reach = {variable.name: (cells, quiet) for variable, cells, quiet in cover.silences()}
        self._worth = cover.weights * (payoff - cover.off_payoff) * cover.always_silent()
        self._least = float(np.dot(cover.weights, payoff)) - float(self._worth.sum())
        self._silent, self._zeros = self._worth.copy(), np.zeros(len(payoff), dtype=np.int32)
        self._choice: Choice = {}
        self._covered = 0.0

    def value(self) -> float:
        return self._least + self._covered

    def values(self, variable: Variable) -> np.ndarray:
        quiet = self._reach[variable.name][1]
        without = self._without(variable.name)
        chosen = self._choice.get(variable.name)
        now = 0.0 if chosen is None else float(np.dot(1 - quiet[chosen], without))
        return self.value() - now + (1 - quiet) @ without

    def choose(self, name: str, index: int) -> None:
        cells, quiet = self._reach[name]
        without = self._without(name)
        gained = float(np.dot(1 - quiet[index], without))
        if (before := self._choice.get(name)) is not None:
            gained -= float(np.dot(1 - quiet[before], without))
            self._multiply(cells, quiet[before], -1)
        self._multiply(cells, quiet[index], 1)
        self._covered += gained
        self._choice[name] = index

    def bound(self) -> float:
        """``f(G) + Σ_i max_c [f(G ∪ {(i, c)}) − f(G)]``, and never more than all that is within reach."""
        left, gains = np.where(self._zeros == 0, self._silent, 0.0), 0.0
        within = np.zeros(len(left), dtype=bool)
        for cells, quiet in self._reach.values():
            gains += float(((1 - quiet) @ left[cells]).max(initial=0.0))
            within[cells] = True
        return self._least + min(self._covered + gains, float(self._worth[within].sum()))

    def _without(self, name: str) -> np.ndarray:
        """What is silent when the variable has no value, where it reaches."""
        cells, quiet = self._reach[name]
        silent, zeros = self._silent[cells], self._zeros[cells]
        if (chosen := self._choice.get(name)) is not None:
            zero = quiet[chosen] == 0
            zeros = zeros - zero
            silent = silent / np.where(zero, 1.0, quiet[chosen])
        return np.where(zeros == 0, silent, 0.0)

    def _multiply(self, cells: np.ndarray, factor: np.ndarray, sign: int) -> None:
        zero = factor == 0
        self._zeros[cells] += sign * zero
        self._silent[cells] *= np.where(zero, 1.0, factor) ** sign


class _Causes:
    """A noisy-or expectation whose causes pay differently."""

    def __init__(self, cover: ExpectedNoisyOr) -> None:
        self._cover, self._choice = cover, Choice()

    def value(self) -> float:
        return self._at(self._choice)

    def values(self, variable: Variable) -> np.ndarray:
        return np.array([self._at({**self._choice, variable.name: index}) for index in range(variable.size)])

    def choose(self, name: str, index: int) -> None:
        self._choice[name] = index

    def bound(self) -> float:
        """The best payoff everywhere."""
        cover = self._cover
        payoffs = [*(cause.payoff for cause in cover.causes), cover.off_payoff]
        best, worst = np.max(payoffs, axis=0), np.min(payoffs, axis=0)
        return float(np.dot(np.abs(cover.weights), np.where(cover.weights >= 0, best, -worst)))

    def _at(self, choice: Choice) -> float:
        paid, silent = 0.0, self._cover.weights
        for cause in self._cover.causes:
            if cause.variable is not None and cause.variable.name not in choice:
                continue
            acting = cause.activation[choice[cause.variable.name] if cause.variable is not None else 0]
            paid += float(np.dot(silent * acting, cause.payoff))
            silent = silent * (1 - acting)
        return paid + float(np.dot(silent, self._cover.off_payoff))


class _Table:
    """A function that is laid out in full; without a value for a variable, its least."""

    def __init__(self, function: Factor) -> None:
        dense = function.dense()
        self._scope, self._array, self._choice = dense.scope, dense.array, Choice()

    def value(self) -> float:
        return self._at(self._choice)

    def values(self, variable: Variable) -> np.ndarray:
        return np.array([self._at({**self._choice, variable.name: index}) for index in range(variable.size)])

    def choose(self, name: str, index: int) -> None:
        self._choice[name] = index

    def bound(self) -> float:
        return float(self._array.max())

    def _at(self, choice: Choice) -> float:
        return float(np.min(self._array[tuple(choice.get(variable.name, slice(None)) for variable in self._scope)]))
