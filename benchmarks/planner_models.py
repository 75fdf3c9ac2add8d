"""A flat model in pomdp_py's own terms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pomdp_py

from factored_pomdp import Joint

__all__ = ["agent_of"]


class _Numbered:
    """What pomdp_py asks of states, actions and observations: equality and a hash."""

    def __init__(self, number: int) -> None:
        self.number = number

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Numbered) and other.number == self.number

    def __hash__(self) -> int:
        return self.number


class _State(_Numbered, pomdp_py.State):
    pass


class _Action(_Numbered, pomdp_py.Action):
    pass


class _Observation(_Numbered, pomdp_py.Observation):
    pass


class _Transition(pomdp_py.TransitionModel):
    def __init__(self, tables: list[np.ndarray], states: list[_State], rng: np.random.Generator) -> None:
        self._tables, self._states, self._rng = tables, states, rng
        self._cumulative = [table.cumsum(axis=1) for table in tables]

    def probability(self, after: Any, state: Any, action: Any) -> float:
        return float(self._tables[action.number][state.number, after.number])

    def sample(self, state: Any, action: Any) -> Any:
        line = self._cumulative[action.number][state.number]
        return self._states[min(int(line.searchsorted(self._rng.random())), len(line) - 1)]

    def get_all_states(self) -> list[_State]:
        return self._states


class _Seen(pomdp_py.ObservationModel):
    def __init__(self, tables: list[np.ndarray], values: list[_Observation], rng: np.random.Generator) -> None:
        self._tables, self._values, self._rng = tables, values, rng
        self._cumulative = [table.cumsum(axis=1) for table in tables]

    def probability(self, seen: Any, after: Any, action: Any) -> float:
        return float(self._tables[action.number][after.number, seen.number])

    def sample(self, after: Any, action: Any) -> Any:
        line = self._cumulative[action.number][after.number]
        return self._values[min(int(line.searchsorted(self._rng.random())), len(line) - 1)]

    def get_all_observations(self) -> list[_Observation]:
        return self._values


class _Reward(pomdp_py.RewardModel):
    def __init__(self, table: np.ndarray) -> None:
        self._table = table

    def sample(self, state: Any, action: Any, after: Any) -> float:
        return float(self._table[action.number, state.number])


class _Policy(pomdp_py.RolloutPolicy):
    def __init__(self, actions: list[_Action], rng: np.random.Generator) -> None:
        self._actions, self._rng = actions, rng

    def sample(self, state: Any) -> Any:
        return self._actions[int(self._rng.integers(len(self._actions)))]

    def rollout(self, state: Any, history: Any = None) -> Any:
        return self.sample(state)

    def get_all_actions(self, state: Any = None, history: Any = None) -> list[_Action]:
        return self._actions


def agent_of(flat: Joint, rng: np.random.Generator) -> Any:
    """An agent with the initial belief, whose models are the flat model's tables, laid out in full."""
    states = [_State(number) for number in range(len(flat.initial))]
    actions = [_Action(number) for number in range(len(flat.actions))]
    values = [_Observation(number) for number in range(len(flat.observations))]
    belief = pomdp_py.Histogram({state: float(flat.initial[state.number]) for state in states})
    return pomdp_py.Agent(
        belief,
        _Policy(actions, rng),
        _Transition([matrix.toarray() for matrix in flat.transition], states, rng),
        _Seen([matrix.toarray() for matrix in flat.observation], values, rng),
        _Reward(flat.reward),
    )
