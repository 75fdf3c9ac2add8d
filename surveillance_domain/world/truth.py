"""What a simulated world knows and no controller sees: where the targets really are."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Int

__all__ = ["Truth"]


@runtime_checkable
class Truth(Protocol):
    """The targets' true states at one time step; a step gives a new truth and leaves this one as it is."""

    @property
    def cells(self) -> Int[np.ndarray, "targets"]:
        """Number of the free cell each target is in."""

    @property
    def directions(self) -> Int[np.ndarray, "targets"]:
        """Direction bin of each target."""

    @property
    def speeds(self) -> Int[np.ndarray, "targets"]:
        """Index of each target's speed in the set of speeds."""

    @property
    def positions_m(self) -> Float[np.ndarray, "targets 2"]:
        """Where each target is, x and y in metres."""

    def step(self) -> Truth:
        """Move every target for one time step."""
