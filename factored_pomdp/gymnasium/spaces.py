"""Named values as the numbers of Gymnasium's spaces, and back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium.spaces import Dict, Discrete, MultiDiscrete, Space

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value, Variable

__all__ = ["LegalDiscrete", "LegalMultiDiscrete", "Mask", "action_mask", "action_space", "observation_space"]

Mask = np.ndarray | tuple[np.ndarray, ...]
"""For each value of an action 1 (legal) or 0, int8; a tuple of these where there are several action variables."""


class _SamplesWhatIsLegal:
    """A space that draws legal actions only; seeding it stands for a fresh start, as it is done at a reset."""

    def __init__(self, size: Any, at_start: Mask) -> None:
        self.at_start = self.legal = at_start
        super().__init__(size)  # type: ignore[call-arg]

    def sample(self, mask: Any = None, probability: Any = None) -> Any:
        drawn_from = self.legal if mask is None and probability is None else mask
        return super().sample(drawn_from, probability)  # type: ignore[misc]

    def seed(self, seed: int | None = None) -> Any:
        self.legal = self.at_start
        return super().seed(seed)  # type: ignore[misc]


class LegalDiscrete(_SamplesWhatIsLegal, Discrete[Any]):
    """One action variable."""


class LegalMultiDiscrete(_SamplesWhatIsLegal, MultiDiscrete[Any]):
    """Several action variables."""


def action_mask(model: FactoredPOMDP, known: Mapping[str, Value]) -> Mask:
    """Which values may be chosen where known variables stand so, as ``action_space.sample(mask)`` takes it."""
    masks = tuple(
        np.array([model.is_legal({variable.name: value}, known) for value in variable.values], dtype=np.int8)
        for variable in model.actions
    )
    return masks[0] if len(masks) == 1 else masks


def action_space(model: FactoredPOMDP, at_start: Mask) -> Space[Any]:
    """Positions of the values: a number for one action variable, an array for several, in the model's order."""
    sizes = [variable.size for variable in model.actions]
    if model.legal:
        return LegalDiscrete(sizes[0], at_start) if len(sizes) == 1 else LegalMultiDiscrete(sizes, at_start)
    return Discrete(sizes[0]) if len(sizes) == 1 else MultiDiscrete(sizes)


def observation_space(seen: Sequence[Variable], read: Sequence[Variable]) -> Space[Any]:
    """Positions of the values, by name where there are several variables.

    Parameters
    ----------
    seen : sequence of Variable
        One number more than there are values: the last one says that there was nothing to see yet.
    read : sequence of Variable
        Known state variables.
    """
    by_name: dict[str, Space[Any]] = {variable.name: Discrete(variable.size + 1) for variable in seen}
    by_name |= {variable.name: Discrete(variable.size) for variable in read}
    return next(iter(by_name.values())) if len(by_name) == 1 else Dict(by_name)
