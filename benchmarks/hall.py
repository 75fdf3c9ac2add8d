"""The setting of most benchmarks: the paper's hall, with beliefs that are dense, and one whole step through the API."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

import factored_pomdp as fp
from factored_pomdp.beliefs import ProductBelief
from solvers import DecomposedMyopic
from surveillance_domain.model.build import UNSEEN, Surveillance, surveillance_model
from surveillance_domain.site.load import load_site

__all__ = ["Hall"]


@dataclass(frozen=True, eq=False)
class Hall:
    """A site with some targets, a dense belief, the decision for it, and what came of that.

    Attributes
    ----------
    belief : ProductBelief
        Every state of every target has some probability: the most work that a belief can make.
    action, known, sighting : dict
        The best joint action, the presets after it, and what the targets, at random cells, then show.
    """

    surveillance: Surveillance
    solver: DecomposedMyopic
    belief: ProductBelief
    action: Mapping[str, Any]
    known: Mapping[str, Any]
    sighting: Mapping[str, Any]

    @classmethod
    def of(cls, targets: int, rng: np.random.Generator, site: str = "hall") -> Hall:
        """Build the model, draw belief and cells, decide."""
        surveillance = surveillance_model(load_site(site), targets)
        start = fp.initial_belief(surveillance.model)
        dense = [rng.exponential(size=array.shape) for array in start.arrays]
        belief = start.with_arrays([array / array.sum(axis=0) for array in dense])
        solver = DecomposedMyopic(surveillance.model)
        action = solver.decide(belief).action
        known = belief.predict(action).known
        numbers = rng.integers(0, surveillance.site.grid.size, targets)
        return cls(surveillance, solver, belief, action, known, _sighting(surveillance, known, numbers))

    def fresh(self) -> ProductBelief:
        """The belief without what was worked out of it before, so that every step predicts anew."""
        return self.belief.with_arrays(self.belief.arrays)

    def updated(self) -> ProductBelief:
        """Prediction and conditioning."""
        return self.fresh().predict(self.action).condition(self.sighting, self.known)

    def decided(self) -> ProductBelief:
        """The whole decision: predict, choose, condition."""
        belief = self.fresh()
        return belief.predict(self.solver.decide(belief).action).condition(self.sighting, self.known)

    def presets(self) -> list[int]:
        """Each camera's preset after the action, by position."""
        return _presets(self.surveillance, self.known)


def _presets(surveillance: Surveillance, known: Mapping[str, Any]) -> list[int]:
    cameras = surveillance.site.cameras
    return [[p.name for p in camera.presets].index(known[f"{camera.name}.preset"]) for camera in cameras]


def _sighting(surveillance: Surveillance, known: Mapping[str, Any], numbers: np.ndarray) -> dict[str, Any]:
    """What every target shows at a free cell of that number, with eyes that see all that is in view."""
    grid = surveillance.site.grid
    seen = surveillance.views.seen(_presets(surveillance, known)) > 0
    cells = [(int(column), int(row)) for column, row in grid.cells[numbers]]
    shown = [cell if seen[number] else UNSEEN for number, cell in zip(numbers, cells, strict=True)]
    return {f"{target}.sighting": value for target, value in zip(surveillance.targets, shown, strict=True)}
