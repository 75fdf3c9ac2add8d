"""Random small models with terminal states: over known variables, over one block, over several, product or tie."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor
from tests.strategies import random_models, random_module_as_found

__all__ = ["ending_models", "with_end"]


def with_end(model: fp.FactoredPOMDP, terminal: fp.Factor) -> fp.FactoredPOMDP:
    """The same model with terminal states."""
    return fp.FactoredPOMDP(
        name=model.name,
        states=model.states,
        actions=model.actions,
        observations=model.observations,
        transition=model.transition,
        observation=model.observation,
        reward=model.reward,
        initial=model.initial,
        discount=model.discount,
        known=model.declared_known,
        legal=model.legal,
        terminal=terminal,
    )


@st.composite
def ending_models(draw: st.DrawFn, most_states: int = 3) -> fp.FactoredPOMDP:
    """Models whose episodes do not end at once for certain; some of them start in a terminal state now and then."""
    model = draw(random_models(most_states))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    scope = draw(st.lists(st.sampled_from(list(model.states)), unique=True, min_size=1, max_size=3))
    ends: Mapping[str, np.ndarray] = {v.name: rng.random(v.size) < 0.4 for v in scope}
    shape = [variable.size for variable in scope]
    kind = draw(st.sampled_from(["any", "all", "drawn"]))
    if kind == "drawn":
        table = rng.random(shape) < 0.3
    else:
        grids = np.meshgrid(*ends.values(), indexing="ij")
        table = np.any(grids, axis=0) if kind == "any" else np.all(grids, axis=0)
    with random_module_as_found():
        ending = with_end(model, DenseFactor(scope, table))
        flat = fp.joint(ending)
    assume(flat.initial[~flat.terminal].sum() > 0)
    return ending
