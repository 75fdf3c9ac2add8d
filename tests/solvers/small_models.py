"""Small random models of one state, action and observation variable, for solvers on flat tables."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import factored_pomdp as fp
from tests.strategies import random_module_as_found

__all__ = ["small_models"]


def _distributions(rng: np.random.Generator, shape: tuple[int, ...]) -> np.ndarray:
    table = rng.dirichlet(np.full(shape[-1], 0.7), size=shape[:-1])
    table = np.where(rng.random(shape) < rng.choice([0.0, 0.4]), 0.0, table)
    table[..., 0] += table.sum(axis=-1) == 0
    return table / table.sum(axis=-1, keepdims=True)


@st.composite
def small_models(
    draw: st.DrawFn, most_states: int = 4, most_actions: int = 3, discount: float = 0.9
) -> fp.FactoredPOMDP:
    """Random tables, dense or with zeros; rewards read the action, the state and the next state."""
    states, actions = draw(st.integers(2, most_states)), draw(st.integers(2, most_actions))
    seen = draw(st.integers(1, 3))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    digits = draw(st.integers(0, 6))
    with random_module_as_found():
        return _model(rng, states, actions, seen, digits, discount)


def _model(
    rng: np.random.Generator, states: int, actions: int, seen: int, digits: int, discount: float
) -> fp.FactoredPOMDP:
    reward = np.round(rng.normal(size=(actions, states, states)), digits)
    return fp.FactoredPOMDP(
        name="small",
        states=[fp.Variable("s", range(states))],
        actions=[fp.Variable("a", range(actions))],
        observations=[fp.Variable("z", range(seen))],
        transition={"s": fp.table("a", "s", "s.next", values=_distributions(rng, (actions, states, states)))},
        observation={"z": fp.table("a", "s.next", "z", values=_distributions(rng, (actions, states, seen)))},
        reward=fp.table("a", "s", "s.next", values=reward),
        initial={"s": fp.table("s", values=_distributions(rng, (states,)))},
        discount=discount,
    )
