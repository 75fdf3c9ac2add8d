"""Which first actions are worth a longer look: the base policy's own, its neighbours, and the next best for one step.

The base action comes first; then the legal actions that differ from it in one action variable (one valve turned
elsewhere, one machine more repaired), best first by the reward of the next step; then all others, in that order too,
where the joint actions can be listed.
"""

from __future__ import annotations

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.variables import Value
from solvers.base import Decision
from solvers.myopic import DecomposedMyopic

__all__ = ["FirstAction", "first_actions"]

FirstAction = tuple[dict[str, Value], float]
"""A joint action, and its expected reward in the next step."""


def first_actions(myopic: DecomposedMyopic, belief: ProductBelief, base: Decision, most: int) -> list[FirstAction]:
    """Legal joint actions with their one-step values, the base action first.

    Parameters
    ----------
    base : Decision
        The myopic choice at this belief.
    most : int
        How many actions, at least 1.
    """

    def rank(found: FirstAction) -> tuple[int, float]:
        changed = sum(value != base.action[name] for name, value in found[0].items())
        return min(changed, 2), -found[1]

    return sorted(myopic.values(belief), key=rank)[:most]
