"""Choosing from point estimates: what MP, MSP and the full-information bound share.

Every target that is thought to be somewhere has one cell, and weights over directions and speeds; the choice is the one
that `PomdpController` would make for such a belief. Targets of which nothing is known count for nothing.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float, Int

from factored_pomdp.beliefs import initial_belief
from factored_pomdp.variables import Value
from solvers.myopic import DecomposedMyopic
from surveillance_domain.control.base import Choice
from surveillance_domain.model.build import Surveillance

__all__ = ["PointEstimates", "PointPlanner"]


class PointEstimates:
    """One estimate a target.

    Attributes
    ----------
    cells : (targets,) int
        Number of the free cell; -1: nothing known.
    headings : (targets, directions) float
        Weights that sum to one.
    paces : (targets, speeds) float
        Weights that sum to one.
    """

    def __init__(self, targets: int, directions: int, speeds: int) -> None:
        self.cells: Int[np.ndarray, " targets"] = np.full(targets, -1)
        self.headings: Float[np.ndarray, "targets directions"] = np.full((targets, directions), 1 / directions)
        self.paces: Float[np.ndarray, "targets speeds"] = np.full((targets, speeds), 1 / speeds)


class PointPlanner:
    """Maximises the expected number of targets observed in the next step, given point estimates."""

    def __init__(self, surveillance: Surveillance) -> None:
        self._belief = initial_belief(surveillance.model)
        self._solver = DecomposedMyopic(surveillance.model)
        self._cameras = tuple(camera.name for camera in surveillance.site.cameras)
        self._grid = surveillance.site.grid
        self.present: Mapping[str, Value] = dict(self._belief.known)

    def choose(self, estimates: PointEstimates) -> Choice:
        """The best presets among those reachable from where the cameras are."""
        array = self.array(estimates)
        belief = self._belief.with_arrays([array], known=self.present)
        prefer = {f"{name}.move": self.present[f"{name}.preset"] for name in self._cameras}
        decision = self._solver.decide(belief, prefer=prefer)
        presets = {name: str(decision.action[f"{name}.move"]) for name in self._cameras}
        return Choice(presets, decision.value, decision.upper_bound, decision.method)

    def array(self, estimates: PointEstimates) -> Float[np.ndarray, "states targets"]:
        """The estimates as a stack of beliefs; zero columns where nothing is known."""
        targets = len(estimates.cells)
        shape = (self._grid.size, estimates.headings.shape[1], estimates.paces.shape[1], targets)
        array = np.zeros(shape)
        placed = np.flatnonzero(estimates.cells >= 0)
        motion = np.einsum("td,tv->dvt", estimates.headings[placed], estimates.paces[placed])
        array[estimates.cells[placed], :, :, placed] = np.moveaxis(motion, -1, 0)
        return array.reshape(-1, targets)

    def predicted(self, estimates: PointEstimates) -> Float[np.ndarray, "cells directions speeds targets"]:
        """Where the targets would be one step later."""
        belief = self._belief.with_arrays([self.array(estimates)], known=self.present)
        action = {f"{name}.move": self.present[f"{name}.preset"] for name in self._cameras}
        predicted = belief.predict(action).arrays[0]
        return predicted.reshape(self._grid.size, estimates.headings.shape[1], estimates.paces.shape[1], -1)

    def turned(self, views: Mapping[str, str | None]) -> None:
        """Learn where the cameras really are."""
        self.present = {f"{name}.preset": view for name, view in views.items()}
