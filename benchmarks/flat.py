"""A transition as one flattened matrix, and plain prediction and conditioning with it: what one writes first."""

from __future__ import annotations

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
    """Beliefs as rows, one matrix P(t' | t), one likelihood vector a target.

    Attributes
    ----------
    matrix : (next states, states) scipy CSR
    beliefs : (targets, states) float
    likelihoods : (targets, states) float
        Of each target's sighting under the presets of the setting.
    """

    matrix: Any
    beliefs: np.ndarray
    likelihoods: np.ndarray

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
        shape = (entries.numbers, (entries.flat(after), entries.flat(before)))
        matrix = sparse.csr_array(shape, shape=(size, size))
        seen = hall.surveillance.views.seen(hall.presets())
        each = size // len(seen)
        grid = hall.surveillance.site.grid
        rows = []
        for target in hall.surveillance.targets:
            shown = hall.sighting[f"{target}.sighting"]
            at_cell = 1 - seen
            if shown != UNSEEN:
                at_cell = np.zeros(len(seen))
                at_cell[grid.number[shown[1], shown[0]]] = 1.0
            rows.append(np.repeat(at_cell, each))
        return cls(matrix, np.ascontiguousarray(hall.belief.arrays[0].T), np.array(rows))

    def predicted_in_turn(self) -> list[np.ndarray]:
        """Target by target."""
        return [self.matrix @ belief for belief in self.beliefs]

    def predicted_at_once(self) -> np.ndarray:
        """All targets in one product, (states, targets)."""
        return self.matrix @ self.beliefs.T

    def updated_in_turn(self) -> list[np.ndarray]:
        """Prediction and conditioning, target by target."""
        posteriors = []
        for belief, likelihood in zip(self.beliefs, self.likelihoods, strict=True):
            unnormalised = (self.matrix @ belief) * likelihood
            posteriors.append(unnormalised / unnormalised.sum())
        return posteriors

    def updated_at_once(self) -> np.ndarray:
        """Prediction and conditioning of all targets, (states, targets)."""
        unnormalised = self.predicted_at_once() * self.likelihoods.T
        return np.asarray(unnormalised / unnormalised.sum(axis=0))
