"""The sawtooth upper bound: values at corners, pulled down by belief points.

``V̄(b) = min_i  c · b + min_{s: b_i(s) > 0} b(s) / b_i(s) · (v_i − c · b_i)``, with c the values at the corners
(Hauskrecht 2000). Time: entries of the class's points.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

__all__ = ["Sawtooth"]


@dataclass(frozen=True, eq=False)
class Sawtooth:
    """Belief points with upper bounds.

    Attributes
    ----------
    corner : (N,) float
        Upper bound at each state.
    classes : (K,) int
        Class of each point, in which all of its states are.
    start : (K + 1,) int
        First entry of each point.
    states, chances : (entries,) arrays
    values : (K,) float
        Upper bound at each point.
    """

    corner: Float[np.ndarray, " states"]
    classes: Int[np.ndarray, " points"]
    start: Int[np.ndarray, " points_and_one"]
    states: Int[np.ndarray, " entries"]
    chances: Float[np.ndarray, " entries"]
    values: Float[np.ndarray, " points"]

    def __len__(self) -> int:
        return len(self.classes)

    @cached_property
    def _drop(self) -> Float[np.ndarray, " points"]:
        """How far each point lies below the corners' plane."""
        plane = np.add.reduceat(self.chances * self.corner[self.states], self.start[:-1]) if len(self) else np.empty(0)
        return np.asarray(self.values - plane)

    def at(self, belief: Float[np.ndarray, " states"], number: int) -> float:
        """The bound at a belief that lies in one class."""
        plane = float(belief @ self.corner)
        if not len(self):
            return plane
        ratios = np.minimum.reduceat(belief[self.states] / self.chances, self.start[:-1])
        return plane + min(0.0, float((ratios * self._drop)[self.classes == number].min(initial=0.0)))
