"""Lazy greedy choice with swaps, for more joint actions than can be listed; says how far from the best it may be.

Source: Fisher, Nemhauser, Wolsey, "An analysis of approximations for maximizing submodular set functions II",
Mathematical Programming Study 8 (1978): one value a variable is a partition matroid, over which greedy reaches half of
a monotone submodular function. The tighter bound ``f(G) + Σ_i max_c [f(G ∪ {(i, c)}) − f(G)]`` is given, which holds
for the final choice G too; functions that are not submodular are bounded by their maxima.
Cost: O(rounds · variables) looks at a variable (`Objective`).
"""

from __future__ import annotations

import heapq
from collections.abc import Mapping, Sequence

from factored_pomdp.factors import Factor
from factored_pomdp.variables import Value, Variable
from solvers.base import Decision
from solvers.maximise.objective import Objective

__all__ = ["greedy_with_swaps"]

_BETTER = 1e-12
_ROUNDS = 20


def greedy_with_swaps(
    functions: Sequence[Factor], actions: Sequence[Variable], prefer: Mapping[str, Value] | None = None
) -> Decision:
    """A good joint action and an upper bound; the method says "not proved" unless they meet."""
    objective = Objective(functions)
    _fill(objective, actions, prefer or {})
    rounds = _swap(objective, actions)
    value = objective.value()
    bound = max(value, objective.bound())
    action = {variable.name: variable.values[objective.choice[variable.name]] for variable in actions}
    method = f"lazy greedy, {rounds} round{'s' if rounds != 1 else ''} of swaps"
    if bound - value > 1e-9 * max(1.0, abs(value)):
        method += f" (not proved: within {bound - value:.6g} of the best)"
    return Decision(action, value, bound, method)


def _fill(objective: Objective, actions: Sequence[Variable], prefer: Mapping[str, Value]) -> None:
    """Take the (variable, value) with the largest gain; gains that shrank are looked at again only when they lead."""

    def best(order: int) -> tuple[float, bool, int, int]:
        gains = objective.gains(actions[order])
        values = actions[order].values
        return min(
            (-float(gain), values[n] != prefer.get(actions[order].name), order, n) for n, gain in enumerate(gains)
        )

    heap = [(best(order), 0) for order in range(len(actions))]
    heapq.heapify(heap)
    while heap:
        (_, _, order, index), seen_at = heapq.heappop(heap)
        if seen_at != len(objective.choice):
            heapq.heappush(heap, (best(order), len(objective.choice)))
        else:
            objective.choose(actions[order], index)


def _swap(objective: Objective, actions: Sequence[Variable]) -> int:
    """Change one variable at a time while that helps; how many rounds that took."""
    for done in range(_ROUNDS):
        improved = False
        for variable in actions:
            gains = objective.gains(variable)
            index = int(gains.argmax())
            if gains[index] > _BETTER * max(1.0, abs(objective.value())):
                objective.choose(variable, index)
                improved = True
        if not improved:
            return done + 1
    return _ROUNDS
