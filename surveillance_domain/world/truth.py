"""What a simulated world knows and no controller sees: where the targets really are."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Int

__all__ = ["OUTSIDE", "Truth"]

OUTSIDE = -1
"""In place of a cell's number: the target is not on the map. It then has no position (nan), and a direction and a speed
without meaning."""


@runtime_checkable
class Truth(Protocol):
    """The targets' true states at one time step; a step gives a new truth and leaves this one as it is."""

    @property
    def cells(self) -> Int[np.ndarray, "targets"]:
        """Number of the free cell each target is in, or `OUTSIDE`."""

    @property
    def directions(self) -> Int[np.ndarray, "targets"]:
        """Direction bin of each target."""

    @property
    def speeds(self) -> Int[np.ndarray, "targets"]:
        """Index of each target's speed in the set of speeds."""

    @property
    def positions_m(self) -> Float[np.ndarray, "targets 2"]:
        """Where each target is, x and y in metres; nan while it is outside."""

    def step(self) -> Truth:
        """Move every target for one time step."""
