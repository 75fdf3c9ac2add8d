"""A truth of which every step is worked out once, however many watch it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from jaxtyping import Float, Int
from numpy import ndarray

from surveillance_domain.world.truth import Truth

__all__ = ["Remembered"]


@dataclass(frozen=True, eq=False)
class Remembered:
    """A truth, and those that follow it as far as somebody asked; they are kept as long as this one is."""

    truth: Truth

    @cached_property
    def positions_m(self) -> Float[ndarray, "targets 2"]:
        """Where each target is."""
        return self.truth.positions_m

    @cached_property
    def cells(self) -> Int[ndarray, "targets"]:
        """Number of the cell each target is in."""
        return self.truth.cells

    @cached_property
    def directions(self) -> Int[ndarray, "targets"]:
        """Direction bin of each target."""
        return self.truth.directions

    @cached_property
    def speeds(self) -> Int[ndarray, "targets"]:
        """Index of each target's speed."""
        return self.truth.speeds

    def step(self) -> Remembered:
        """One time step later."""
        return self._next

    @cached_property
    def _next(self) -> Remembered:
        return Remembered(self.truth.step())
