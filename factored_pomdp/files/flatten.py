"""One state variable, one action variable, one observation variable: what a ``.pomdp`` file can hold."""

from __future__ import annotations

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.expansion import joint
from factored_pomdp.factors import DenseFactor, Factor, SparseFactor
from factored_pomdp.files.defaults import as_terms
from factored_pomdp.files.names import words
from factored_pomdp.files.sums import summed
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.validation import is_certain
from factored_pomdp.variables import Variable, count

__all__ = ["MOST_STATES", "flattened", "read_back"]

MOST_STATES = 500_000
"""Joint states, actions or observations that a flat model may have."""


def flattened(model: FactoredPOMDP) -> FactoredPOMDP:
    """The same decision problem over joint states, actions and observations.

    A model of one variable of each kind stays as it is, its rewards summed: to one, or where that would be too large
    a table, to ``reward`` and ``reward_exceptions``, of which the second reads all variables that the first does. Any
    other goes through `joint`: rewards become those expected of a step; known variables that do not follow from what is
    known and done become part of the observation; terminal states become absorbing and earn nothing.

    Raises
    ------
    TooLarge
        Before anything is laid out.
    ValueError
        Where the model says which actions are legal: a flat file has no place for that.
    """
    if model.legal:
        raise ValueError(f"{model.name}: a file cannot say which actions are legal ({', '.join(model.legal)})")
    sizes = {"states": model.joint_states, "actions": model.joint_actions, "observations": model.joint_observations}
    for what, size in sizes.items():
        if size > MOST_STATES:
            raise TooLarge(f"{model.name} has {size:,} joint {what}; a .pomdp file may have {MOST_STATES:,}")
    if not _is_flat(model):
        return _expanded(model)
    if len(model.reward) == 1:
        return model
    rewards = summed(tuple(model.reward.values()))
    return _expanded(model) if rewards is None else _with_rewards(model, rewards)


def read_back(model: FactoredPOMDP) -> tuple[Variable, ...]:
    """Variables declared known of which somebody who knows the actions would not know the next value anyhow."""
    follows = {name for name in model.declared_known if is_certain(model.transition[name], f"{name}.next")}
    states = {variable.name for variable in model.states}
    while loose := {
        name
        for name in follows
        if any(v.now.name in states and v.now.name not in model.declared_known for v in model.transition[name].scope)
    }:
        follows -= loose
    return tuple(v for v in model.states if v.name in model.declared_known and v.name not in follows)


def _is_flat(model: FactoredPOMDP) -> bool:
    one_each = len(model.states) == len(model.actions) == 1 and len(model.observations) <= 1
    seen = not read_back(model) or (not model.observations and len(model.states) == 1)
    return one_each and seen and model.terminal is None


def _with_rewards(model: FactoredPOMDP, rewards: tuple[Factor, ...]) -> FactoredPOMDP:
    return FactoredPOMDP(
        states=model.states,
        actions=model.actions,
        observations=model.observations,
        transition=model.transition,
        observation=model.observation,
        reward=as_terms("reward", rewards),
        initial=model.initial,
        discount=model.discount,
        known=model.declared_known,
        name=model.name,
    )


def _expanded(model: FactoredPOMDP) -> FactoredPOMDP:
    flat, also = joint(model), read_back(model)
    if model.joint_observations * count(also) > MOST_STATES:
        names = ", ".join(variable.name for variable in also)
        raise TooLarge(f"{model.name}: too many observations, as {names} would be part of them")
    state = Variable("state", _joined([v.values for v in model.states], [v.name for v in model.states]))
    action = Variable("action", _joined([v.values for v in model.actions], [v.name for v in model.actions]))
    parts = [*model.observations, *also]
    seen = Variable("observation", _joined([v.values for v in parts], [v.name for v in parts]))
    read = _position_of(also, model.states)
    moves = _stacked(flat.transition, [action, state, state.next])
    views = _stacked(flat.observation, [action, state.next, seen.renamed("without what is read")])
    columns = views.coordinates.copy()
    columns[:, 2] = columns[:, 2] * count(also) + read[columns[:, 1]]
    return FactoredPOMDP(
        states=[state],
        actions=[action],
        observations=[seen],
        transition={"state": moves},
        observation={"observation": SparseFactor([action, state.next, seen], columns, views.numbers)},
        reward={"reward": DenseFactor([action, state], flat.reward)},
        initial={"state": DenseFactor([state], flat.initial)},
        discount=model.discount,
        name=model.name,
    )


def _stacked(matrices: list[object], scope: list[Variable]) -> SparseFactor:
    listed = [matrix.tocoo() for matrix in matrices]  # type: ignore[attr-defined]
    coordinates = np.concatenate(
        [np.stack([np.full(m.nnz, k), *m.coords], axis=1) for k, m in enumerate(listed)], dtype=np.int64
    )
    return SparseFactor(scope, coordinates, np.concatenate([m.data for m in listed]))


def _position_of(some: tuple[Variable, ...], states: tuple[Variable, ...]) -> np.ndarray:
    """For each joint state, the joint position of the values of some of its variables."""
    values = np.unravel_index(np.arange(count(states)), [variable.size for variable in states])
    position = np.zeros(count(states), dtype=np.int64)
    for variable in some:
        position = position * variable.size + values[states.index(variable)]
    return position


def _joined(values: list[tuple[object, ...]], names: list[str]) -> list[str]:
    """A name for each joint assignment: the values where they tell it, else the variables' names as well."""
    import itertools

    if len(names) == 1:
        return words(values[0])
    plain = ["_".join(words(combination)) for combination in itertools.product(*(words(v) for v in values))]
    told = len(set(plain)) == len(plain) and all(name and name[0].isalpha() for name in plain)
    if told:
        return plain
    pairs = [[f"{name}-{word}" for word in words(listed)] for name, listed in zip(words(names), values, strict=True)]
    return ["_".join(combination) for combination in itertools.product(*pairs)] if pairs else ["nothing"]
