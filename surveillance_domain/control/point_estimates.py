"""Choosing from point estimates: what MP, MSP and the full-information bound share.

Every target that is thought to be somewhere has one cell, and weights over directions and speeds; the choice is the one
that `PomdpController` would make for such a belief. Targets of which nothing is known count for nothing.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from jaxtyping import Float, Int

from factored_pomdp.beliefs import initial_belief
from factored_pomdp.variables import Value
from surveillance_domain.control.base import Choice
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import Sighting

__all__ = ["PointEstimates", "PointPlanner"]


class PointEstimates:
    """One estimate a target.

    Attributes
    ----------
    cells : (targets,) int
        Number of the free cell, or of outside, the number after the last of them; -1: nothing known.
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
    """Maximises the expected number of targets observed in the next step, given point estimates.

    Attributes
    ----------
    present : dict
        Actual preset of each camera (under its variable's name); ``None`` while it is away.
    held : collection of str
        Cameras that stay where they are.
    """

    def __init__(self, surveillance: Surveillance) -> None:
        self._belief = initial_belief(surveillance.model)
        self._chooser = PresetChooser(surveillance)
        self._places = surveillance.model.variable(f"{surveillance.targets[0]}.location").size
        self.present: Mapping[str, Value] = dict(self._belief.known)
        self.held: Collection[str] = frozenset()

    def choose(self, estimates: PointEstimates) -> Choice:
        """The best presets among those reachable from where the cameras are."""
        belief = self._belief.with_arrays([self._array(estimates)], known=self.present)
        return self._chooser.choose(belief, self.held)

    def turned(self, sighting: Sighting) -> None:
        """Learn where the cameras really are."""
        self.present = {f"{name}.preset": view for name, view in sighting.views.items()}
        self.held = sighting.held

    def _array(self, estimates: PointEstimates) -> Float[np.ndarray, "states targets"]:
        """The estimates as a stack of beliefs; zero columns where nothing is known."""
        targets = len(estimates.cells)
        array = np.zeros((self._places, estimates.headings.shape[1], estimates.paces.shape[1], targets))
        placed = np.flatnonzero(estimates.cells >= 0)
        motion = np.einsum("td,tv->tdv", estimates.headings[placed], estimates.paces[placed])
        array[estimates.cells[placed], :, :, placed] = motion
        return array.reshape(-1, targets)
