"""What becomes of a target's belief when the model calls the sighting impossible (model.md, "Zero mass").

A target seen where its belief has no mass starts anew at that cell, with every direction that can lead there. One that
was not seen although all its mass was in view starts anew over the free cells out of view within one longest move plus
one cell (along each axis, as moves are shared among cells) of where it was thought to be; if there are none, over all
cells out of view; if there are none either, the prediction stands. Where there are doors, outside is out of view, and
within a move of every cell that is within a move of a door.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.build import Surveillance, motion_parameters
from surveillance_domain.world.base import Cell

__all__ = ["TargetRestart"]

_ROUNDING = 1e-9


class TargetRestart:
    """Gives a target a new belief."""

    def __init__(self, surveillance: Surveillance) -> None:
        self._surveillance = surveillance
        parameters = motion_parameters(surveillance.site)
        longest = max(parameters.speeds_mps) * parameters.step_s / surveillance.site.grid.cell_m
        self._reach = math.floor(longest + 1 + _ROUNDING)
        self._doors = [cell for door in parameters.doors for cell in door.cells]

    def __call__(
        self,
        seen: Cell | None,
        predicted: Float[np.ndarray, "places directions speeds"],
        known: Mapping[str, Any],
        previous: Float[np.ndarray, "places directions speeds"],
        missed: Float[np.ndarray, " cells"] | None = None,
    ) -> Float[np.ndarray, "places directions speeds"]:
        """The new belief of one target.

        Parameters
        ----------
        seen : (int, int) or None
            The cell, column and row, at which it was; ``None``: it was not seen.
        predicted, previous : (places, directions, speeds) float
            Its belief before the sighting, and before the step.
        known : mapping
            Actual preset of each camera; ``None``: it had no view.
        missed : (cells,) float, optional
            Probability that cameras which look at no preset of their own miss a target.
        """
        grid, views, cameras = self._surveillance.site.grid, self._surveillance.views, self._surveillance.site.cameras
        if seen is not None:
            return self.seen_at(seen)
        presets = [known[f"{camera.name}.preset"] for camera in cameras]
        names = [[preset.name for preset in camera.presets] for camera in cameras]
        numbers = [None if p is None else of.index(str(p)) for p, of in zip(presets, names, strict=True)]
        hidden = views.seen(numbers) < 1
        if missed is not None:
            hidden &= missed > 0
        thought = previous.sum(axis=(1, 2)) > 0
        within = _near(grid.number, thought[: grid.size], self._reach)
        if self._doors:
            hidden = np.append(hidden, True)
            at_a_door = any(within[grid.number[row, column]] for column, row in self._doors)
            within = np.append(within, at_a_door or thought[-1])
        near = hidden & within
        cells = near if near.any() else hidden
        if not cells.any():
            return predicted
        fresh = np.zeros_like(predicted)
        fresh[cells] = 1.0
        return np.asarray(fresh / fresh.sum())

    def seen_at(self, cell: Cell) -> Float[np.ndarray, "places directions speeds"]:
        """The belief of a target of which nothing is known but that it was just seen at a cell."""
        number = int(self._surveillance.site.grid.number[cell[1], cell[0]])
        belief = np.zeros_like(self._arrivals)
        belief[number] = self._arrivals[number]
        return belief

    @cached_property
    def _arrivals(self) -> Float[np.ndarray, "places directions speeds"]:
        """For each cell the directions and speeds with which a target can have come into it; all where none can.

        A pair counts if some cell leads there in that direction at that speed and the direction can be taken in that
        cell: the location table alone has entries for directions that walls rule out.
        """
        model, target = self._surveillance.model, self._surveillance.targets[0]
        place, heading, speed = (model.variable(f"{target}.{part}") for part in ("location", "direction", "speed"))
        table = model.transition[f"{target}.location"].sparse()
        turning = model.transition[f"{target}.direction"].dense()
        before, taken, pace, after = (
            table.coordinates[:, table.scope.index(variable)]
            for variable in (place, heading.next, speed.next, place.next)
        )
        possible = turning.array.max(axis=turning.scope.index(heading)) > 0
        possible = possible[before, pace, taken] if place in turning.scope else possible[taken]
        came = np.zeros((place.size, heading.size, speed.size), dtype=bool)
        came[after[possible], taken[possible], pace[possible]] = True
        came[~came.any(axis=(1, 2))] = True
        return np.asarray(came / came.sum(axis=(1, 2), keepdims=True))


def _near(number: np.ndarray, support: np.ndarray, reach: int) -> np.ndarray:
    """Free cells within ``reach`` cells (in both axes) of some cell of the support."""
    from scipy.ndimage import maximum_filter

    on_map = np.zeros(number.shape, dtype=bool)
    on_map[number >= 0] = support[number[number >= 0]]
    return np.asarray(maximum_filter(on_map, size=2 * reach + 1, mode="constant")[number >= 0])
