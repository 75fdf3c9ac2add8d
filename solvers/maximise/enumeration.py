"""Every joint action, by broadcasting: certain, exponential in the number of action variables.

Cost: one addition for each function and joint action; memory one number a joint action. A noisy-or expectation is
multiplied out in two halves and joined by one matrix product.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from factored_pomdp.factors import Factor
from factored_pomdp.variables import Value, Variable
from solvers.base import Decision

__all__ = ["enumerate_all"]

_TIE = 1e-12


def enumerate_all(
    functions: Sequence[Factor], actions: Sequence[Variable], prefer: Mapping[str, Value] | None = None
) -> Decision:
    """The best of all joint actions; among equals the one that keeps most preferred values, then the first."""
    shape = tuple(variable.size for variable in actions)
    tables = [function.array_over(actions) for function in functions]
    total = sum(tables[1:], tables[0]) if tables else np.zeros(shape)
    if total.shape != shape:
        total = np.broadcast_to(total, shape)
    values = total.ravel()
    best = float(values.max())
    tied = (values >= best - _TIE * max(1.0, abs(best))).nonzero()[0]
    chosen = int(tied[0]) if len(tied) == 1 or not prefer else _most_kept(tied, actions, prefer)
    index = np.unravel_index(chosen, total.shape)
    action = {v.name: v.values[int(i)] for v, i in zip(actions, index, strict=True)}
    return Decision(action, float(values[chosen]), best, f"enumeration of {total.size:,} joint actions")


def _most_kept(tied: np.ndarray, actions: Sequence[Variable], prefer: Mapping[str, Value]) -> int:
    kept = np.zeros(len(tied))
    for variable, index in zip(actions, np.unravel_index(tied, [v.size for v in actions]), strict=True):
        if prefer.get(variable.name) in variable.values:
            kept += index == variable.index(prefer[variable.name])
    return int(tied[int(kept.argmax())])
