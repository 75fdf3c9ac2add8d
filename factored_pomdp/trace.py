"""Why this action? One record a step: what was believed, what every action was worth, what came of the chosen one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import Value, Variable

__all__ = ["ALL_SHOWN", "BEST_SHOWN", "record"]

ALL_SHOWN = 100
"""So many joint actions are listed in full."""

BEST_SHOWN = 10
"""So many of the best are listed where there are more."""

Valued = Sequence[tuple[Mapping[str, Value], float]]


def record(
    model: FactoredPOMDP,
    state: Mapping[str, Value],
    belief: Any,
    decision: Any,
    valued: Valued | None,
    observation: Mapping[str, Value],
    reward: float,
) -> dict[str, Any]:
    """One step as JSON holds it.

    Parameters
    ----------
    belief : belief
        Before the step; has ``marginal(name)`` for state variables that are not known.
    decision : Decision
    valued : sequence of (action, value), optional
        What the policy compared, in any order; ``None`` for a policy that has no values to tell.

    Returns
    -------
    dict
        ``state`` (the truth), ``belief`` (probabilities of the values of each hidden variable, those without mass left
        out), ``action``, ``value``, ``upper_bound``, ``method``, ``values`` (best first; all of them up to `ALL_SHOWN`,
        else the `BEST_SHOWN` best), ``actions_valued`` (how many there were), ``observation``, ``reward``.
    """
    known = structure_of(model).known
    hidden = [variable for variable in model.states if variable.name not in known]
    return {
        "state": _named(state),
        "belief": {variable.name: _probabilities(variable, belief) for variable in hidden},
        "action": _named(decision.action),
        "value": decision.value,
        "upper_bound": decision.upper_bound if math.isfinite(decision.upper_bound) else None,
        "method": decision.method,
        **_values(valued),
        "observation": _named(observation),
        "reward": reward,
    }


def _values(valued: Valued | None) -> dict[str, Any]:
    if valued is None:
        return {"values": None, "actions_valued": 0}
    best_first = sorted(valued, key=lambda entry: -entry[1])
    shown = best_first if len(best_first) <= ALL_SHOWN else best_first[:BEST_SHOWN]
    listed = [{"action": _named(action), "value": value} for action, value in shown]
    return {"values": listed, "actions_valued": len(best_first)}


def _probabilities(variable: Variable, belief: Any) -> dict[str, float]:
    marginal = belief.marginal(variable.name)
    numbers = np.asarray(getattr(marginal, "array", marginal), dtype=float)
    return {str(value): float(p) for value, p in zip(variable.values, numbers, strict=True) if p > 0}


def _named(values: Mapping[str, Value]) -> dict[str, str]:
    return {name: str(value) for name, value in values.items()}
