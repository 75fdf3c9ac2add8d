"""Random small models in which one factor of a chosen kind ties two of three hidden variables."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor
from tests.strategies import random_distribution, random_module_as_found

__all__ = ["tied_models"]


@st.composite
def tied_models(draw: st.DrawFn, kind: str) -> fp.FactoredPOMDP:
    """Hidden ``x, y, z``, of which one factor of a kind joins ``x`` and ``y``; a switch that an action turns."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    sizes = [draw(st.integers(2, 3)) for _ in range(3)]
    both_slices = draw(st.booleans())
    with random_module_as_found():
        return _model(rng, kind, sizes, both_slices)


def _model(rng: np.random.Generator, kind: str, sizes: list[int], both_slices: bool) -> fp.FactoredPOMDP:
    x, y, z = hidden = [fp.Variable(name, range(size)) for name, size in zip("xyz", sizes, strict=True)]
    switch, turn = fp.Variable("switch", ["up", "down"]), fp.Variable("turn", ["up", "down"])
    seen = [fp.Variable(f"seen.{name}", ["a", "b"]) for name in "xyz"]

    def table(*scope: fp.Variable) -> DenseFactor:
        return DenseFactor(scope, random_distribution(rng, tuple(v.size for v in scope), sparse_too=False))

    def reward(*scope: fp.Variable) -> DenseFactor:
        return DenseFactor(scope, rng.normal(size=[v.size for v in scope]))

    transition = {v.name: table(v, switch.next, v.next) for v in hidden}
    observation = {o.name: table(v.next, switch.next, o) for v, o in zip(hidden, seen, strict=True)}
    rewards = {v.name: reward(v.next, o, turn) for v, o in zip(hidden, seen, strict=True)}
    initial = {v.name: table(v) for v in hidden}
    if kind == "transition":
        transition["y"] = table(x.next if both_slices else x, y, switch, y.next)
    elif kind == "observation":
        observation["seen.y"] = table(x.next, y.next, turn, seen[1])
    elif kind == "reward":
        rewards["both"] = reward(*((x, y.next) if both_slices else (seen[0], y.next)), switch)
    elif kind == "initial":
        initial["y"] = table(x, y)
    return fp.FactoredPOMDP(
        name=f"{kind} tie",
        states=[z, y, switch, x],
        actions=[turn],
        observations=seen,
        transition={**transition, "switch": lambda turn: turn},
        observation=observation,
        reward=rewards,
        initial={**initial, "switch": "up"},
    )
