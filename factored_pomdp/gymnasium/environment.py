"""A model as a Gymnasium environment: what the agent sees and reads back, in numbers."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Dict

from factored_pomdp import registry
from factored_pomdp.beliefs import initial_belief
from factored_pomdp.gymnasium.spaces import (
    LegalDiscrete,
    LegalMultiDiscrete,
    action_mask,
    action_space,
    observation_space,
)
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.simulation import Simulation
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import Value, Variable

__all__ = ["Environment", "of_domain"]


def of_domain(domain: str, belief: bool = False, **options: Any) -> Environment:
    """An installed domain's environment.

    Parameters
    ----------
    belief : bool
        Whether `Environment` tells the belief.
    **options
        The domain's own.

    Raises
    ------
    ValueError
        As `factored_pomdp.domain`.
    """
    return Environment(registry.domain(domain, **options), belief)


class Environment(gymnasium.Env[Any, Any]):
    """A model as a world to act in; random numbers are drawn from ``np_random``.

    Actions are positions in the action variables' values. Observations are positions too: of each observation variable
    (one more stands for "nothing seen yet", as after `reset`), and of each known state variable that no observation
    shows. `decoded` and `encoded` translate. The reward is that of the very transition; ``terminated`` tells of a
    terminal state; how long an episode may last is up to ``gymnasium.make(…, max_episode_steps=…)``.

    ``info`` holds ``action_mask`` and, if asked for, ``belief``: for each block of hidden variables (their names, with
    commas) its probabilities, an axis each; left out once the episode is over.

    Parameters
    ----------
    model : FactoredPOMDP
    belief : bool
        Whether to keep the belief and tell it.

    Attributes
    ----------
    belief : ProductBelief or None
        The same for policies that take it.

    Raises
    ------
    ValueError
        Where legal actions depend on what the agent cannot know, or every episode is over before it begins.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - that is how Gymnasium declares it

    def __init__(self, model: FactoredPOMDP, belief: bool = False) -> None:
        structure = structure_of(model)
        hidden = {variable.name for variable in model.states} - set(structure.known)
        for name, rule in model.legal.items():
            if read := sorted(hidden & set(rule.names)):
                raise ValueError(
                    f"legal values of {name} depend on the hidden {', '.join(read)}: no mask can tell them"
                )
        start = initial_belief(model) if belief or model.terminal is not None else None
        self.model, self.belief = model, start if belief else None
        self._start, self._world = self.belief, Simulation(model)
        self._known = [variable for variable in model.states if variable.name in structure.known]
        self._read = [v for v in model.states if v.name in structure.known and v.name not in structure.shown_by]
        self._state: dict[str, Value] | None = None
        self.observation_space = observation_space(model.observations, self._read)
        any_start = self._world.start(np.random.default_rng(0))  # known variables start with certainty
        self.action_space = action_space(model, action_mask(model, _values(self._known, any_start)))

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """A state drawn from the initial belief, given that the episode does not end at once."""
        super().reset(seed=seed)
        self._state = self._world.start(self.np_random)
        while self.model.is_terminal(self._state):
            self._state = self._world.start(self.np_random)
        self.belief = self._start
        return self._numbers({}, self._state), self._info(self._state)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """One step.

        Raises
        ------
        ValueError
            For an action that there is not, or that is not legal here: which ones are.
        ResetNeeded
            Before the first `reset`, and after the end.
        """
        if self._state is None or self.model.is_terminal(self._state):
            raise ResetNeeded("the episode is over or has not begun: call reset()")
        chosen = self._action(action)
        state, seen, reward = self._world.step(self._state, chosen, self.np_random)
        self._state, ended = state, self.model.is_terminal(state)
        if self.belief is not None and not ended:
            self.belief = self.belief.predict(chosen).condition(seen, known=_values(self._read, state))
        return self._numbers(seen, state), float(reward), ended, False, self._info(state)

    def encoded(self, action: Any) -> Any:
        """A model's action (named values, or a bare one) as this environment takes it."""
        values = self.model.action(action)
        numbers = [variable.index(values[variable.name]) for variable in self.model.actions]
        return numbers[0] if len(numbers) == 1 else np.array(numbers)

    def decoded(self, observation: Any) -> dict[str, Value]:
        """Named values of an observation; those that there were none of yet are left out."""
        variables = [*self.model.observations, *self._read]
        numbers = observation if isinstance(self.observation_space, Dict) else {variables[0].name: observation}
        return {v.name: v.values[int(numbers[v.name])] for v in variables if int(numbers[v.name]) < v.size}

    def _action(self, action: Any) -> dict[str, Value]:
        if action not in self.action_space:
            sizes = ", ".join(f"{variable.name} below {variable.size}" for variable in self.model.actions)
            raise ValueError(f"action {action!r}: expected positions of values ({sizes}), as in {self.action_space}")
        numbers = np.ravel(action).tolist()
        return {v.name: v.values[number] for v, number in zip(self.model.actions, numbers, strict=True)}

    def _numbers(self, seen: Mapping[str, Value], state: Mapping[str, Value]) -> Any:
        observed = self.model.observations
        numbers = {v.name: np.int64(v.index(seen[v.name]) if v.name in seen else v.size) for v in observed}
        numbers |= {v.name: np.int64(v.index(state[v.name])) for v in self._read}
        return numbers if isinstance(self.observation_space, Dict) else next(iter(numbers.values()))

    def _info(self, state: Mapping[str, Value]) -> dict[str, Any]:
        info: dict[str, Any] = {"action_mask": action_mask(self.model, _values(self._known, state))}
        if isinstance(self.action_space, LegalDiscrete | LegalMultiDiscrete):
            self.action_space.legal = action_mask(self.model, _values(self._known, state))
        if self.belief is not None and not self.model.is_terminal(state):
            info["belief"] = {
                ", ".join(names): self.belief.block(names[0]).array.copy() for names in self.belief.blocks
            }
        return info


def _values(variables: Iterable[Variable], state: Mapping[str, Value]) -> dict[str, Value]:
    return {variable.name: state[variable.name] for variable in variables}
