"""The paper's algorithm of Theorem 1 in its printed order, vectorised in numpy: O(|A| |Z| |T| m) a decision.

For every joint action, every observation of a cell in the joint field of view, and every target: the unnormalised
posterior over T (eq:belup2 without η) and the sum of its rewards (eq:policy4), added up over targets (eq:policy3). The
predicted beliefs are worked out once a decision, by one sparse product; tables are made beforehand and not timed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from benchmarks.flat import Flat
from benchmarks.hall import Hall

__all__ = ["TheoremOne"]


@dataclass(frozen=True, eq=False)
class TheoremOne:
    """Everything that does not depend on the belief.

    Attributes
    ----------
    actions : list of tuples of int
        Each camera's preset, by position.
    predict : callable
        Predicted beliefs, (states, targets).
    in_view : list of (cells,) int
        For each joint action the cells z of its joint field of view.
    likelihoods : (cells, states) float
        P(z | t') of a cell in view.
    rewards : (actions, states) float
        R(t', C'): one where the target is in the joint field of view.
    """

    actions: list[tuple[int, ...]]
    predict: Callable[[], np.ndarray]
    in_view: list[np.ndarray]
    likelihoods: np.ndarray
    rewards: np.ndarray

    @classmethod
    def of(cls, hall: Hall) -> TheoremOne:
        """Lay the tables out."""
        flat, views = Flat.of(hall), hall.surveillance.views
        actions = list(product(*(range(len(camera.presets)) for camera in hall.surveillance.site.cameras)))
        in_view = [np.flatnonzero(views.seen(action)) for action in actions]
        cells, states = hall.surveillance.site.grid.size, flat.beliefs.shape[1]
        cell_of = np.repeat(np.arange(cells), states // cells)
        likelihoods = (cell_of == np.arange(cells)[:, None]).astype(float)
        rewards = np.array([likelihoods[seen].sum(axis=0) for seen in in_view])
        return cls(actions, flat.predicted_at_once, in_view, likelihoods, rewards)

    def values(self) -> np.ndarray:
        """V(B, A) of every joint action, in the printed order of sums."""
        predicted = self.predict()
        values = np.zeros(len(self.actions))
        for number, cells in enumerate(self.in_view):
            for cell in cells:
                unnormalised = self.likelihoods[cell][:, None] * predicted
                values[number] += (self.rewards[number] @ unnormalised).sum()
        return values

    def decided(self) -> tuple[int, ...]:
        """The best joint action (eq:policy1)."""
        return self.actions[int(self.values().argmax())]

    def values_as_products(self) -> np.ndarray:
        """The same multiplications, with the posteriors left implicit so that BLAS can do them."""
        predicted = self.predict()
        values = np.zeros(len(self.actions))
        for number, cells in enumerate(self.in_view):
            values[number] = ((self.likelihoods[cells] * self.rewards[number]) @ predicted).sum()
        return values

    def action_of(self, hall: Hall, position: int) -> dict[str, Any]:
        """One of the joint actions by the model's names."""
        chosen = zip(hall.surveillance.site.cameras, self.actions[position], strict=True)
        return {f"{camera.name}.move": camera.presets[preset].name for camera, preset in chosen}
