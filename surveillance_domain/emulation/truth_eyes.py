"""Eyes without pictures: what a perfect detector would make of them, drawn from the model at the true cells.

For long runs in virtual time, where a picture for every look would only cost time. Everything else is real: positions
are read from the camera over HTTP, and a camera that fails, or really looks elsewhere, sees nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from surveillance_domain.cameras.base import Camera, Position
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.build import Surveillance
from surveillance_domain.vision.observe import Observed
from surveillance_domain.world.detections import Detections
from surveillance_domain.world.eyes import Look

__all__ = ["TruthEyes"]


class TruthEyes:
    """Detections by the model's own probabilities.

    Targets that move there beyond those of the model are seen as markers that nobody knows.

    Parameters
    ----------
    surveillance : Surveillance
    emulated : EmulatedSite
    rng : numpy.random.Generator
    """

    def __init__(self, surveillance: Surveillance, emulated: EmulatedSite, rng: np.random.Generator) -> None:
        self._cameras, self._emulated = surveillance.site.cameras, emulated
        self._targets = surveillance.targets
        everybody = replace(surveillance, targets=tuple(look.name for look in emulated.looks))
        self._detections = Detections(everybody, rng.spawn(len(everybody.targets)))

    def look(self, camera: Camera, budget_s: float) -> Look:
        told = camera.position(budget_s)
        return Look(told, Position(*self._emulated.cameras[camera.name].motors.true()))

    def seen(self, looks: Mapping[str, Look], views: Mapping[str, str | None]) -> Observed:
        numbers: dict[str, int | None] = dict.fromkeys(views)
        for camera in self._cameras:
            name, view = camera.name, views[camera.name]
            for number, preset in enumerate(camera.presets):
                at = Position(preset.pan, preset.tilt, preset.zoom)
                if preset.name == view and looks[name].found.agrees(at, camera.tolerance_deg):
                    numbers[name] = number
        found = self._detections.draw(numbers, self._emulated.truth.cells)
        strangers = [look for look in self._emulated.looks if look.name not in self._targets]
        unknown = {look.name if look.marker is None else look.marker: found[look.name] for look in strangers}
        return Observed(
            {target: found[target] for target in self._targets},
            {identity: cell for identity, cell in unknown.items() if cell is not None},
            without_identity=0,
            out_of_view=0,
        )
