"""A transition as one flattened matrix, and plain prediction and conditioning with it: what one writes first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.hall import Hall
from factored_pomdp.factors import Factor
from factored_pomdp.variables import count
from surveillance_domain.model.build import UNSEEN

__all__ = ["Flat"]


@dataclass(frozen=True, eq=False)
class Flat:
    """Beliefs as rows, and one matrix P(t' | t) for all targets.

    Attributes
    ----------
    matrix : (next states, states) scipy CSR
    beliefs : (targets, states) float
    seen : (cells,) float
        Probability of being seen at each cell under the presets of the setting.
    number : dict
        Number of each cell.
    sightings : list
        What each target showed.
    """

    matrix: Any
    beliefs: np.ndarray
    seen: np.ndarray
    number: Mapping[Any, int]
    sightings: list[Any]

    @classmethod
    def of(cls, hall: Hall) -> Flat:
        """From the model's own factors, multiplied out."""
        from scipy import sparse

        model, target = hall.surveillance.model, hall.surveillance.targets[0]
        before = [model.variable(f"{target}.{part}") for part in ("location", "direction", "speed")]
        after = [variable.next for variable in before]
        product: Factor = model.transition[before[0].name]
        for variable in before[1:]:
            product = product.product(model.transition[variable.name])
        entries = product.sparse()
        size = count(before)
        matrix = sparse.csr_array((entries.numbers, (entries.flat(after), entries.flat(before))), shape=(size, size))
        seen = hall.surveillance.views.seen(hall.presets())
        number = {value: position for position, value in enumerate(before[0].values)}
        sightings = [hall.sighting[f"{target}.sighting"] for target in hall.surveillance.targets]
        return cls(matrix, np.ascontiguousarray(hall.belief.arrays[0].T), seen, number, sightings)

    def predicted_in_turn(self) -> list[np.ndarray]:
        """Target by target."""
        return [self.matrix @ belief for belief in self.beliefs]

    def predicted_at_once(self) -> np.ndarray:
        """All targets in one product, (states, targets)."""
        return np.asarray(self.matrix @ self.beliefs.T)

    def updated_in_turn(self) -> list[np.ndarray]:
        """Prediction and conditioning, target by target."""
        silent = np.repeat(1 - self.seen, self._each)
        posteriors = []
        for belief, sighting in zip(self.beliefs, self.sightings, strict=True):
            unnormalised = (self.matrix @ belief) * self._likelihood(sighting, silent)
            posteriors.append(unnormalised / unnormalised.sum())
        return posteriors

    def updated_at_once(self) -> np.ndarray:
        """Prediction and conditioning of all targets, (states, targets)."""
        silent = np.repeat(1 - self.seen, self._each)
        likelihoods = np.array([self._likelihood(sighting, silent) for sighting in self.sightings])
        unnormalised = self.predicted_at_once() * likelihoods.T
        return np.asarray(unnormalised / unnormalised.sum(axis=0))

    @property
    def _each(self) -> int:
        """States a cell."""
        return self.beliefs.shape[1] // len(self.seen)

    def _likelihood(self, sighting: Any, silent: np.ndarray) -> np.ndarray:
        """P(sighting | state) of perfect eyes, (states,)."""
        if sighting == UNSEEN:
            return silent
        likelihood = np.zeros(len(silent))
        first = self.number[sighting] * self._each
        likelihood[first : first + self._each] = 1.0
        return likelihood
