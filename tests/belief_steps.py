"""A product belief beside the joint one that it stands for, and steps that both take."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor

__all__ = ["Step", "gap", "joint_of", "multiplied", "next_step"]


def multiplied(model: fp.FactoredPOMDP, belief: fp.ProductBelief) -> np.ndarray:
    """The product belief as an array over joint states."""
    array = np.ones([1] * len(model.states))
    for names in belief.blocks:
        array = array * belief.block(names[0]).array_over(model.states)
    for name, value in belief.known.items():
        variable = model.variable(name)
        certain = [float(value == other) for other in variable.values]
        array = array * np.reshape(certain, [v.size if v == variable else 1 for v in model.states])
    return array


def joint_of(model: fp.FactoredPOMDP, belief: fp.ProductBelief) -> fp.JointBelief:
    return fp.JointBelief(model, DenseFactor(model.states, multiplied(model, belief)))


def gap(model: fp.FactoredPOMDP, belief: fp.ProductBelief, joint: fp.JointBelief) -> float:
    """Largest difference over joint states."""
    return float(np.abs(multiplied(model, belief) - joint.table.array_over(model.states)).max())


@dataclass(frozen=True)
class Step:
    """An action, and what could come of it."""

    action: Mapping[str, Any]
    observation: Mapping[str, Any]
    read: Mapping[str, Any]


def next_step(model: fp.FactoredPOMDP, joint: fp.JointBelief, rng: np.random.Generator, skip: float = 0.0) -> Step:
    """A random action, and an observation and read-back drawn from the joint belief; some things not looked at."""
    action = {variable.name: variable.values[rng.integers(variable.size)] for variable in model.actions}
    predicted = joint.predict(action).table.array_over(model.states)
    position = rng.choice(predicted.size, p=predicted.ravel() / predicted.sum())
    index = np.unravel_index(position, predicted.shape)
    after = {v.name: v.values[i] for v, i in zip(model.states, index, strict=True)}
    given = {**action, **{f"{name}.next": value for name, value in after.items()}}
    observation = {}
    for variable in model.observations:
        line = model.observation[variable.name].condition(given).array_over([variable])
        drawn = variable.values[rng.choice(variable.size, p=line / line.sum())]
        if rng.random() >= skip:
            observation[variable.name] = drawn
    return Step(action, observation, {name: after[name] for name in model.declared_known})
