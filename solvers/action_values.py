"""What each joint action is worth, not only the best: the answer to "why this action?".

A solver or policy that can tell has ``values(belief) -> list of (action, value)`` over legal joint actions.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float

from factored_pomdp.factors import Factor
from factored_pomdp.variables import Value, Variable, count
from solvers.flat import FlatModel
from solvers.maximise import ENUMERATED

__all__ = ["Valued", "one_step_values", "summed_values"]

Valued = list[tuple[dict[str, Value], float]]
"""Joint actions with their values, in no order."""


def summed_values(
    functions: Sequence[Factor], actions: Sequence[Variable], legal: Sequence[Factor], chosen: Mapping[str, Value]
) -> Valued:
    """Joint actions and their sums of local functions.

    All that are legal while they can be enumerated; beyond that the chosen one, and those that differ from it in one
    variable.

    Parameters
    ----------
    functions : sequence of Factor
        Over action variables only.
    legal : sequence of Factor
        Over one action variable each: zero where its value may not be chosen.
    """
    if count(actions) > ENUMERATED:
        near = [dict(chosen), *_changed(actions, legal, chosen)]
        return [(action, sum(float(f.condition(action).dense().array) for f in functions)) for action in near]
    total = np.zeros([variable.size for variable in actions])
    allowed = np.ones(total.shape, dtype=bool)
    for function in functions:
        total = total + function.array_over(actions)
    for rule in legal:
        allowed = allowed & (rule.array_over(actions) > 0)
    names = [variable.name for variable in actions]
    combinations = itertools.product(*(variable.values for variable in actions))
    listed = zip(combinations, total.ravel().tolist(), allowed.ravel().tolist(), strict=True)
    return [(dict(zip(names, values, strict=True)), worth) for values, worth, may in listed if may]


def _changed(
    actions: Sequence[Variable], legal: Sequence[Factor], chosen: Mapping[str, Value]
) -> list[dict[str, Value]]:
    changed = []
    for variable in actions:
        rules = [rule for rule in legal if variable in rule.scope]
        for value in variable.values:
            if value != chosen[variable.name] and all(rule.value({variable.name: value}) for rule in rules):
                changed.append({**chosen, variable.name: value})
    return changed


def one_step_values(
    flat: FlatModel,
    belief: Float[np.ndarray, " states"],
    legal: Bool[np.ndarray, " actions"],
    worth_after: Callable[[Float[np.ndarray, " states"]], float] | None,
) -> Valued:
    """``R(b, a) + γ Σ_z P(z | b, a) V(b_az)`` of every legal action.

    Parameters
    ----------
    worth_after : callable or None
        V, asked at beliefs that lie in one class each; ``None`` where this is the last step.
    """
    valued = []
    for number in np.flatnonzero(legal):
        worth = float(belief @ flat.reward[number])
        if worth_after is not None:
            for joint in _joint_with_what_is_seen(flat, belief, int(number)):
                chance = float(joint.sum())
                worth += flat.discount * chance * worth_after(joint / chance)
        valued.append((flat.actions[number], worth))
    return valued


def _joint_with_what_is_seen(
    flat: FlatModel, belief: Float[np.ndarray, " states"], action: int
) -> list[Float[np.ndarray, " states"]]:
    """``P(s', z | b, a)`` for each z (with what is read back) that is possible."""
    tables, size = flat.tables, flat.size
    moved = np.asarray(belief @ flat.transition[action])
    states = np.flatnonzero(moved)
    starts = tables.seen_start[action * size + states]
    lengths = tables.seen_start[action * size + states + 1] - starts
    entries = np.repeat(starts - np.cumsum(lengths) + lengths, lengths) + np.arange(lengths.sum())
    order = np.argsort(tables.seen_column[entries], kind="stable")
    columns, entries = tables.seen_column[entries][order], entries[order]
    places = np.repeat(states, lengths)[order]
    chances = moved[places] * tables.seen_chance[entries]
    joints = []
    for part in np.split(np.arange(len(columns)), np.flatnonzero(np.diff(columns)) + 1):
        joint = np.zeros(size)
        joint[places[part]] = chances[part]
        joints.append(joint)
    return joints
