"""The expectation of a payoff under a noisy-or, as a function of its causes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from factored_pomdp.factors.base import Factor, address
from factored_pomdp.factors.dense import DenseFactor
from factored_pomdp.factors.noisy_or import NoisyOr
from factored_pomdp.factors.sparse import SparseFactor
from factored_pomdp.variables import Value, Variable

__all__ = ["ExpectedNoisyOr", "WeightedCause"]

_KEPT = 2_000_000
"""Entries of the payoff table (joint cause values, contexts) up to which it is kept for the next weights."""


@dataclass(frozen=True, eq=False)
class WeightedCause:
    """A cause and what it pays where it decides.

    Attributes
    ----------
    variable : Variable or None
    activation : (values, contexts) float
    payoff : (contexts,) float
    """

    variable: Variable | None
    activation: np.ndarray
    payoff: np.ndarray


class ExpectedNoisyOr(Factor):
    """``Σ_ctx w(ctx) [Σ_i p_i(c_i) ∏_{j<i} (1 − p_j(c_j)) r_i + ∏_i (1 − p_i(c_i)) r_off]`` over the causes ``c``.

    For one payoff ``r_i = 1``, ``r_off = 0`` this is weighted (probabilistic) coverage, Σ_l w(l) P(seen | l, C) of the
    design's model; one number for each cause value and context is held, however many causes there are.

    Parameters
    ----------
    weights : (contexts,) float
    causes : sequence of WeightedCause
    off_payoff : (contexts,) float
    """

    def __init__(self, weights: np.ndarray, causes: Sequence[WeightedCause], off_payoff: np.ndarray) -> None:
        self.weights, self.causes, self.off_payoff = weights, tuple(causes), off_payoff
        self._unweighted: dict[str, Any] = {}
        self.scope = tuple(dict.fromkeys(cause.variable for cause in causes if cause.variable is not None))

    @classmethod
    def of(cls, table: NoisyOr, weights: np.ndarray, payoff: np.ndarray) -> ExpectedNoisyOr:
        """Expectation of ``payoff`` (contexts or 1, child values) under ``table`` with weights (contexts,)."""
        contexts = weights.shape[0]
        full = np.broadcast_to(payoff, (contexts, table.child.size))
        uniform = payoff.shape[0] == 1
        causes = [
            WeightedCause(
                c.variable,
                c.activation,
                c.emission @ payoff[0] if uniform else np.asarray(c.emission.multiply(payoff).sum(axis=1)).ravel(),
            )
            for c in table.causes
        ]
        return cls(weights, causes, full[:, table.off_index])

    def with_weights(self, weights: np.ndarray) -> ExpectedNoisyOr:
        """The same payoff under other weights; what was worked out without the weights is shared."""
        other = object.__new__(ExpectedNoisyOr)
        other.__dict__ |= self.__dict__
        other.weights = weights
        return other

    @property
    def storage(self) -> tuple[int, ...]:
        causes = [array for cause in self.causes for array in (cause.activation, cause.payoff)]
        return tuple(n for array in (self.weights, self.off_payoff, *causes) for n in address(array))

    @property
    def stored(self) -> int:
        return sum(cause.activation.size for cause in self.causes)

    def condition(self, assignment: Mapping[str, Value]) -> ExpectedNoisyOr:
        causes = []
        for cause in self.causes:
            if cause.variable is None or cause.variable.name not in assignment:
                causes.append(cause)
            elif (value := assignment[cause.variable.name]) is not None:
                row = cause.activation[cause.variable.index(value)][None]
                causes.append(WeightedCause(None, row, cause.payoff))
        return ExpectedNoisyOr(self.weights, causes, self.off_payoff)

    def renamed(self, names: Mapping[str, str]) -> ExpectedNoisyOr:
        if not any(names.get(name, name) != name for name in self.names):
            return self
        causes = [
            WeightedCause(
                None if c.variable is None else c.variable.renamed(names.get(c.variable.name, c.variable.name)),
                c.activation,
                c.payoff,
            )
            for c in self.causes
        ]
        return ExpectedNoisyOr(self.weights, causes, self.off_payoff)

    def substituted(self, variable: Variable, by: Variable, indexes: np.ndarray) -> ExpectedNoisyOr:
        causes = [
            WeightedCause(by, c.activation[indexes], c.payoff) if c.variable == variable else c for c in self.causes
        ]
        return ExpectedNoisyOr(self.weights, causes, self.off_payoff)

    def fold(self) -> tuple[np.ndarray, np.ndarray]:
        """Expected payoff before anything is silent, and silence, as (joint cause values, contexts) arrays each.

        Joint values are in row-major order of `scope`. Multiplied out, so meant for few causes at a time.
        """
        paid = np.zeros((1, len(self.weights)))
        silent = np.ones((1, len(self.weights)))
        for cause in self.causes:
            paid = (paid[:, None] + silent[:, None] * cause.activation[None] * cause.payoff).reshape(
                -1, len(self.weights)
            )
            silent = (silent[:, None] * (1 - cause.activation)[None]).reshape(-1, len(self.weights))
        return paid, silent

    def split(self, first: int) -> tuple[ExpectedNoisyOr, ExpectedNoisyOr]:
        """The first causes (nothing paid for silence) and the others."""
        before = ExpectedNoisyOr(self.weights, self.causes[:first], np.zeros_like(self.off_payoff))
        return before, ExpectedNoisyOr(self.weights, self.causes[first:], self.off_payoff)

    def at(self, choice: Mapping[str, int]) -> float:
        """The number at one joint choice of value positions, cause by cause."""
        paid, silent = 0.0, self.weights
        for cause in self.causes:
            acting = cause.activation[choice[cause.variable.name] if cause.variable is not None else 0]
            paid += float(np.dot(silent * acting, cause.payoff))
            silent = silent * (1 - acting)
        return paid + float(np.dot(silent, self.off_payoff))

    @property
    def pays_once(self) -> bool:
        """Whether every cause pays the same, and no less than silence: then the function is monotone and submodular."""
        if (self.weights < 0).any():
            return False
        payoffs = [cause.payoff for cause in self.causes]
        if not payoffs:
            return True
        seen = self.weights > 0
        return all(np.array_equal(p[seen], payoffs[0][seen]) for p in payoffs) and bool(
            (payoffs[0][seen] >= self.off_payoff[seen]).all()
        )

    def silences(self) -> tuple[tuple[Variable, np.ndarray, np.ndarray], ...]:
        """For each variable the contexts that it reaches, (reached,), and ``∏ (1 − p)`` there, (values, reached)."""
        if "silences" not in self._unweighted:
            self._unweighted["silences"] = tuple((variable, *self._silence(variable)) for variable in self.scope)
        found: tuple[tuple[Variable, np.ndarray, np.ndarray], ...] = self._unweighted["silences"]
        return found

    def always_silent(self) -> np.ndarray:
        """``∏ (1 − p)`` of the causes that are decided, (contexts,)."""
        decided = [cause.activation[0] for cause in self.causes if cause.variable is None]
        return np.prod([1 - row for row in decided], axis=0) if decided else np.ones(len(self.weights))

    def _silence(self, variable: Variable) -> tuple[np.ndarray, np.ndarray]:
        causes = [cause.activation for cause in self.causes if cause.variable == variable]
        reached = np.flatnonzero(np.any([(activation > 0).any(axis=0) for activation in causes], axis=0))
        return reached, np.prod([1 - activation[:, reached] for activation in causes], axis=0)

    def array_over(self, scope: Iterable[Variable]) -> np.ndarray:
        payoff, order = self._unweighted.get("payoff"), tuple(scope)
        if payoff is None or order != self.scope:
            return super().array_over(order)
        table: np.ndarray = (payoff @ self.weights).reshape([variable.size for variable in self.scope])
        return table

    def dense(self) -> DenseFactor:
        self.refuse_if_large(self.scope)
        shared = self._shared
        if shared is not None:
            tables = [self.condition({shared.name: value}).array_over(self.scope) for value in shared.values]
            return DenseFactor(self.scope, np.concatenate(tables, axis=self.scope.index(shared)))
        shape = [variable.size for variable in self.scope]
        if self.size * len(self.weights) <= _KEPT:
            if "payoff" not in self._unweighted:
                paid, silent = self.fold()
                self._unweighted["payoff"] = paid + silent * self.off_payoff
            return DenseFactor(self.scope, (self._unweighted["payoff"] @ self.weights).reshape(shape))
        first, second = self.split((len(self.causes) + 1) // 2)
        paid_first, silent_first = first.fold()
        paid_second, silent_second = second.fold()
        rest = paid_second + silent_second * self.off_payoff
        table = (paid_first @ self.weights)[:, None] + (silent_first * self.weights) @ rest.T
        return DenseFactor(self.scope, table.reshape(shape))

    @cached_property
    def _shared(self) -> Variable | None:
        """A variable that stands behind several causes (two sensors that one action moves)."""
        times = Counter(cause.variable for cause in self.causes if cause.variable is not None)
        return next((variable for variable in times if times[variable] > 1), None)

    def sparse(self) -> SparseFactor:
        return self.dense().sparse()
