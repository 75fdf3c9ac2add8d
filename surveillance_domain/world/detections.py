"""Drawn detections: which targets cameras at their presets detect, and the cell that is reported."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.world.base import Cell
from surveillance_domain.world.truth import OUTSIDE

if TYPE_CHECKING:
    from scipy.sparse import csr_array

    from surveillance_domain.model.build import Surveillance

__all__ = ["Detections"]


class Detections:
    """The model's detections, drawn with luck that depends on target, camera and step alone.

    Parameters
    ----------
    surveillance : Surveillance
    luck : sequence of numpy.random.Generator
        One a target.
    """

    def __init__(self, surveillance: Surveillance, luck: Sequence[np.random.Generator]) -> None:
        self._site, self._views, self._luck = surveillance.site, surveillance.views, luck
        self._targets = surveillance.targets
        self._kernels = _kernels(surveillance)
        self._order = sorted(range(len(self._site.cameras)), key=lambda camera: self._views.noise_m[camera])

    def draw(self, presets: Mapping[str, int | None], cells: Int[np.ndarray, " targets"]) -> dict[str, Cell | None]:
        """The cell at which each target is reported, given each camera's preset (``None``: no view).

        Nobody detects a target that is outside.
        """
        views = {
            name: self._views.detection[camera][preset]
            for camera, (name, preset) in enumerate((one.name, presets[one.name]) for one in self._site.cameras)
            if preset is not None
        }
        return {target: None if one is None else one[0] for target, one in self.reported(views, cells).items()}

    def reported(
        self, views: Mapping[str, Float[np.ndarray, " cells"]], cells: Int[np.ndarray, " targets"]
    ) -> dict[str, tuple[Cell, str] | None]:
        """For each target the cell that is reported and the camera that reports it, given what cameras detect where.

        Parameters
        ----------
        views : mapping of str to (cells,) float
            Probability of a detection in each free cell, for the cameras that have a view.
        cells : (targets,) int
            Where they are.
        """
        draws = [luck.random(2 * len(self._order)) for luck in self._luck]
        found = [self._detected(views, int(cell), luck) for cell, luck in zip(cells, draws, strict=True)]
        return dict(zip(self._targets, found, strict=True))

    def _detected(
        self, views: Mapping[str, Float[np.ndarray, " cells"]], cell: int, luck: np.ndarray
    ) -> tuple[Cell, str] | None:
        """The first camera, in order of noise, that detects decides which cell is reported."""
        if cell == OUTSIDE:
            return None
        for position, camera in enumerate(self._order):
            name = self._site.cameras[camera].name
            if name in views and luck[2 * position] < views[name][cell]:
                kernel = self._kernels[camera]
                if kernel is None:
                    return self._cell(cell), name
                start, end = kernel.indptr[cell], kernel.indptr[cell + 1]
                row = np.cumsum(kernel.data[start:end])
                drawn = int(np.searchsorted(row, luck[2 * position + 1] * row[-1], side="right"))
                return self._cell(int(kernel.indices[start + min(drawn, end - start - 1)])), name
        return None

    def _cell(self, number: int) -> Cell:
        column, row = self._site.grid.cells[number]
        return int(column), int(row)


def _kernels(surveillance: Surveillance) -> list[csr_array | None]:
    """Confusion of each camera; ``None`` for exact ones."""
    from surveillance_domain.model.confusion import confusion_kernel

    noise = surveillance.views.noise_m
    made = {sigma: confusion_kernel(surveillance.site.grid, sigma) for sigma in set(noise) if sigma > 0}
    return [made.get(sigma) for sigma in noise]
