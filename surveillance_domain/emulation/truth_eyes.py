"""Eyes without pictures: what a perfect detector would make of them, drawn from the model at the true cells.

For long runs in virtual time, where a picture for every look would only cost time. Everything else is real: positions
are read from the camera over HTTP, and a camera that fails, or really looks elsewhere, sees nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.base import Camera, Position
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.elsewhere import Elsewhere, Place
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
        self._surveillance, self._emulated = surveillance, emulated
        self._cameras, self._elsewhere = surveillance.site.cameras, Elsewhere(surveillance.site)
        everybody = replace(surveillance, targets=tuple(look.name for look in emulated.looks))
        self._detections = Detections(everybody, rng.spawn(len(everybody.targets)))

    def look(self, camera: Camera, budget_s: float) -> Look:
        told = camera.position(budget_s)
        return Look(told, Position(*self._emulated.cameras[camera.name].motors.true()))

    def seen(
        self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]
    ) -> Observed:
        shown: dict[str, Float[np.ndarray, " cells"]] = {}
        for camera, detection in zip(self._cameras, self._surveillance.views.detection, strict=True):
            name = camera.name
            for number, preset in enumerate(camera.presets):
                at = Position(preset.pan, preset.tilt, preset.zoom)
                if preset.name == views[name] and looks[name].found.agrees(at, camera.tolerance_deg):
                    shown[name] = detection[number]
            if name in elsewhere and looks[name].found.agrees(Position(*elsewhere[name]), camera.tolerance_deg):
                seen = self._elsewhere.detection(name, elsewhere[name])
                if seen is not None:
                    shown[name] = seen
        found = self._detections.reported(shown, self._emulated.truth.cells)
        targets = self._surveillance.targets
        strangers = {
            look.name: look.name if look.marker is None else look.marker
            for look in self._emulated.looks
            if look.name not in targets
        }
        reports = {strangers.get(name, name): one for name, one in found.items() if one is not None}
        return Observed(
            {target: reports[target][0] if target in reports else None for target in targets},
            {identity: reports[identity][0] for identity in strangers.values() if identity in reports},
            without_identity=0,
            out_of_view=0,
            beyond={who: camera for who, (_, camera) in reports.items() if camera in elsewhere},
        )
