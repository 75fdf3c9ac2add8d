"""Eyes without pictures: what a perfect detector would make of them, drawn from the model at the true cells.

For long runs in virtual time, where a picture for every look would only cost time. Everything else is real: positions
are read from the camera over HTTP, and a camera that fails, or looks elsewhere, sees nothing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from surveillance_domain.cameras.base import Camera
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import Cell
from surveillance_domain.world.detections import Detections
from surveillance_domain.world.eyes import Look

__all__ = ["TruthEyes"]


class TruthEyes:
    """Detections by the model's own probabilities.

    Parameters
    ----------
    surveillance : Surveillance
    emulated : EmulatedSite
    rng : numpy.random.Generator
    """

    def __init__(self, surveillance: Surveillance, emulated: EmulatedSite, rng: np.random.Generator) -> None:
        self._cameras, self._emulated = surveillance.site.cameras, emulated
        self._detections = Detections(surveillance, rng.spawn(len(surveillance.targets)))

    def look(self, camera: Camera, budget_s: float) -> Look:
        return Look(camera.position(budget_s))

    def seen(self, looks: Mapping[str, Look], views: Mapping[str, str | None]) -> dict[str, Cell | None]:
        presets = {one.name: [preset.name for preset in one.presets] for one in self._cameras}
        numbers = {name: None if view is None else presets[name].index(view) for name, view in views.items()}
        return self._detections.draw(numbers, self._emulated.truth.cells)
