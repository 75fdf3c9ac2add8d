"""The simulated world: targets move by a truth, cameras turn to their presets, detections are drawn.

Random numbers are common to all controllers: what target k does, and the luck of camera i with target k at step t,
depend on the seed alone, not on what the controller chose.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Int

from surveillance_domain.model.reachability import reachable
from surveillance_domain.model.views import static_views
from surveillance_domain.world.base import Cell, Sighting
from surveillance_domain.world.detections import Detections
from surveillance_domain.world.truth import OUTSIDE, Truth

if TYPE_CHECKING:
    from surveillance_domain.model.build import Surveillance

__all__ = ["SimulatedWorld"]


class SimulatedWorld:
    """Targets and cameras of a site, in the computer.

    Parameters
    ----------
    surveillance : Surveillance
        Site, views and target names. Cameras start at their first preset.
    truth : Truth
        The targets' first states.
    rng : numpy.random.Generator
        For detections and static cameras only.
    """

    def __init__(self, surveillance: Surveillance, truth: Truth, rng: np.random.Generator) -> None:
        self.truth = truth
        self._site, self._targets = surveillance.site, surveillance.targets
        self._reach = [reachable(camera, self._site.control.step_s) for camera in self._site.cameras]
        self._static = static_views(self._site)
        self._preset = {camera.name: 0 for camera in self._site.cameras}
        eyes, watch = rng.spawn(2)
        self._detections = Detections(surveillance, eyes.spawn(len(self._targets)))
        self._watch = watch.spawn(len(self._targets))
        self._steps = 0

    def move(self, presets: Mapping[str, str]) -> None:
        """Turn cameras to presets that they reach within the step.

        Raises
        ------
        ValueError
            Naming a camera or preset that is not there, or cannot be reached in one step.
        """
        names = {camera.name: [preset.name for preset in camera.presets] for camera in self._site.cameras}
        wanted = dict(self._preset)
        for name, preset in presets.items():
            if name not in names or preset not in names[name]:
                raise ValueError(f"no camera {name!r} with a preset {preset!r} at site {self._site.name}")
            wanted[name] = names[name].index(preset)
        for camera, reach in zip(self._site.cameras, self._reach, strict=True):
            if not reach[self._preset[camera.name], wanted[camera.name]]:
                step = f"{self._site.control.step_s:g} s"
                raise ValueError(f"{camera.name} does not reach {presets[camera.name]!r} within one step of {step}")
        self._preset = wanted

    def observe(self) -> Sighting:
        """Move the targets by one step and look."""
        self.truth = self.truth.step()
        self._steps += 1
        cells = self.truth.cells
        seen = self._detections.draw(self._preset, cells)
        views = {c.name: c.presets[self._preset[c.name]].name for c in self._site.cameras}
        static = self._static_sighting(cells)
        return Sighting(seen, views, self._steps * self._site.control.step_s, static)

    def _static_sighting(self, cells: Int[np.ndarray, " targets"]) -> dict[str, Cell | None]:
        """Every target that some static camera sees, with noise σ₀ + κ · distance of the surest one, on a free cell."""
        if not self._site.static_cameras:
            return {}
        errors = [watch.normal(size=2) for watch in self._watch]
        report: dict[str, Cell | None] = {}
        positions = self.truth.positions_m
        for target, name in enumerate(self._targets):
            sigmas = [
                camera.noise_m[0] + camera.noise_m[1] * float(np.hypot(*(positions[target] - camera.position_m[:2])))
                for number, camera in enumerate(self._site.static_cameras)
                if cells[target] != OUTSIDE and self._static[number, cells[target]]
            ]
            if not sigmas:
                report[name] = None
                continue
            point = positions[target] + min(sigmas) * errors[target]
            nearest = int(((self._site.grid.centres_m - point) ** 2).sum(axis=1).argmin())
            report[name] = self._cell(nearest)
        return report

    def _cell(self, number: int) -> Cell:
        column, row = self._site.grid.cells[number]
        return int(column), int(row)
