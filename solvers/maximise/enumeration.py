"""Every joint action, by broadcasting: certain, exponential in the number of action variables.

Cost: one addition for each function and joint action; memory one number a joint action. A noisy-or expectation is
multiplied out in two halves and joined by one matrix product.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from factored_pomdp.factors import Factor
from factored_pomdp.variables import Variable
from solvers.base import Decision

__all__ = ["enumerate_all"]

_TIE = 1e-12


def enumerate_all(functions: Sequence[Factor], actions: Sequence[Variable]) -> Decision:
    """The best of all joint actions; the first in order of the variables' values among equals."""
    total = np.zeros([variable.size for variable in actions])
    for function in functions:
        total = total + function.array_over(actions)
    best = float(total.max())
    first = int(np.argmax(total >= best - _TIE * max(1.0, abs(best))))
    index = np.unravel_index(first, total.shape)
    action = {v.name: v.values[int(i)] for v, i in zip(actions, index, strict=True)}
    return Decision(action, float(total[index]), best, f"enumeration of {total.size:,} joint actions")
