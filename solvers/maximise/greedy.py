"""Lazy greedy choice with swaps, for more joint actions than can be listed; says how far from the best it may be.

Source: Fisher, Nemhauser, Wolsey, "An analysis of approximations for maximizing submodular set functions II",
Mathematical Programming Study 8 (1978): one value a variable is a partition matroid, over which greedy reaches half of
a monotone submodular function. The tighter bound ``f(G) + Σ_i max_c [f(G ∪ {(i, c)}) − f(G)]`` is given, which holds
for the final choice G too; functions that are not submodular are bounded by their maxima.
Cost: O(rounds · variables · values) evaluations of the functions that read the variable.
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence

import numpy as np

from factored_pomdp.factors import ExpectedNoisyOr, Factor
from factored_pomdp.variables import Value, Variable
from solvers.base import Decision

__all__ = ["greedy_with_swaps"]

_BETTER = 1e-12
_ROUNDS = 20

Choice = dict[str, int]


def greedy_with_swaps(
    functions: Sequence[Factor], actions: Sequence[Variable], prefer: Mapping[str, Value] | None = None
) -> Decision:
    """A good joint action and an upper bound; the method says "not proved" unless they meet."""
    covers = [f for f in functions if isinstance(f, ExpectedNoisyOr) and len(f.scope) > 1]
    tables = [
        (f.scope, f.dense().array) for f in functions if not (isinstance(f, ExpectedNoisyOr) and len(f.scope) > 1)
    ]
    objective = _Objective(covers, tables)
    choice = _greedy(objective, actions, prefer or {})
    value, rounds = _swapped(objective, actions, choice)
    bound = max(value, objective.bound(choice, value))
    action = {variable.name: variable.values[choice[variable.name]] for variable in actions}
    method = f"lazy greedy, {rounds} round{'s' if rounds != 1 else ''} of swaps"
    if bound - value > 1e-9 * max(1.0, abs(value)):
        method += f" (not proved: within {bound - value:.6g} of the best)"
    return Decision(action, value, bound, method)


class _Objective:
    def __init__(self, covers: list[ExpectedNoisyOr], tables: list[tuple[tuple[Variable, ...], np.ndarray]]) -> None:
        self.covers, self.tables = covers, tables

    def value(self, choice: Choice) -> float:
        """Value of a choice; variables left out of it contribute nothing yet (tables: their least)."""
        total = 0.0
        for cover in self.covers:
            total += _partial(cover, choice)
        for scope, array in self.tables:
            index = tuple(choice.get(variable.name, slice(None)) for variable in scope)
            total += float(np.min(array[index]))
        return total

    def bound(self, choice: Choice, value: float) -> float:
        bound = 0.0
        for cover in self.covers:
            bound += _cover_bound(cover, choice)
        for _, array in self.tables:
            bound += float(array.max())
        return bound


def _partial(cover: ExpectedNoisyOr, choice: Choice) -> float:
    paid, silent = 0.0, cover.weights
    for cause in cover.causes:
        if cause.variable is not None and cause.variable.name not in choice:
            continue
        acting = cause.activation[choice[cause.variable.name] if cause.variable is not None else 0]
        paid += float(np.dot(silent * acting, cause.payoff))
        silent = silent * (1 - acting)
    return paid + float(np.dot(silent, cover.off_payoff))


def _cover_bound(cover: ExpectedNoisyOr, choice: Choice) -> float:
    """``f(G) + Σ_i max_c gain``, and never more than the best payoff everywhere."""
    best = np.max([cause.payoff for cause in cover.causes] + [cover.off_payoff], axis=0)
    worst = np.min([cause.payoff for cause in cover.causes] + [cover.off_payoff], axis=0)
    everywhere = float(np.dot(np.abs(cover.weights), np.where(cover.weights >= 0, best, -worst)))
    if not cover.pays_once:
        return everywhere
    payoff = cover.causes[0].payoff
    silent = cover.weights.copy()
    seen_by_any = np.zeros(len(silent), dtype=bool)
    for cause in cover.causes:
        silent = silent * (1 - cause.activation[choice[cause.variable.name] if cause.variable is not None else 0])
        seen_by_any |= (cause.activation > 0).any(axis=0)
    worth = silent * (payoff - cover.off_payoff)
    gains = sum(float((cause.activation @ worth).max()) for cause in cover.causes if cause.variable is not None)
    reachable = float(np.dot(cover.weights, np.where(seen_by_any, payoff, cover.off_payoff)))
    covered = float(np.dot(cover.weights - silent, payoff) + np.dot(silent, cover.off_payoff))
    return min(everywhere, reachable, covered + gains)


def _greedy(objective: _Objective, actions: Sequence[Variable], prefer: Mapping[str, Value]) -> Choice:
    """Take the (variable, value) with the largest gain; gains that shrank are looked at again only when they lead."""
    choice: Choice = {}
    current = objective.value(choice)
    heap = [
        (-(objective.value({variable.name: index}) - current), value != prefer.get(variable.name), order, index, 0)
        for order, variable in enumerate(actions)
        for index, value in enumerate(variable.values)
    ]
    heapq.heapify(heap)
    while heap and len(choice) < len(actions):
        _, fresh, order, index, seen_at = heapq.heappop(heap)
        name = actions[order].name
        if name in choice:
            continue
        if seen_at != len(choice):
            gain = objective.value({**choice, name: index}) - current
            heapq.heappush(heap, (-gain, fresh, order, index, len(choice)))
            continue
        choice[name] = index
        current = objective.value(choice)
    return choice


def _swapped(objective: _Objective, actions: Sequence[Variable], choice: Choice) -> tuple[float, int]:
    """Change one variable at a time while that helps; ``choice`` is changed in place."""
    value = objective.value(choice)
    for done in range(_ROUNDS):
        improved = False
        for variable in actions:
            for index in range(variable.size):
                if index == choice[variable.name]:
                    continue
                other = objective.value({**choice, variable.name: index})
                if other > value + _BETTER * max(1.0, abs(value)):
                    choice[variable.name], value, improved = index, other, True
        if not improved:
            return value, done + 1
    return value, _ROUNDS
