"""What a target's sighting beyond the modelled views does to its belief (model.md, "Zero mass").

Pictures show more than the view that the model gives a camera, so a target may be seen where the model's table of
observations has zero for every state. It was seen all the same: it is in the cell that was reported, but for the error
of whoever reported it. So the prediction is weighed with that camera's confusion kernel, ``P(reported cell | cell)``,
the same for sightings in view and beyond; without noise that leaves the prediction at the cell itself, with speeds and
directions as predicted. Only where the prediction has nothing there does the belief start anew.

A camera that people have turned to where it has no preset is beyond the modelled views altogether: whom it sees is
taken in the same way, and a target that nobody saw is weighed with the probability that this camera misses it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import cache

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import ProductBelief
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.confusion import confusion_kernel
from surveillance_domain.world.base import Cell

__all__ = ["BeyondViews"]


class BeyondViews:
    """Weighs predictions with sightings that the model's views do not allow."""

    def __init__(self, surveillance: Surveillance) -> None:
        grid = surveillance.site.grid
        self._place = surveillance.model.variable(f"{surveillance.targets[0]}.location")
        self._noise_m = {camera.name: camera.cell_noise_m for camera in surveillance.site.cameras}
        self._kernel = cache(lambda noise_m: confusion_kernel(grid, noise_m).tocsc())

    def weighed(
        self, predicted: ProductBelief, cells: Mapping[str, Cell], cameras: Mapping[str, str]
    ) -> tuple[ProductBelief, dict[str, Cell]]:
        """The belief after these sightings alone, and the sightings that it holds impossible, whose targets it leaves.

        Parameters
        ----------
        predicted : ProductBelief
        cells : mapping of str to (int, int)
            Where targets of the belief were seen, column and row.
        cameras : mapping of str to str
            By whom; more names may be in it.

        Raises
        ------
        ValueError
            For a cell that is not free.
        """
        arrays, impossible = list(predicted.arrays), dict[str, Cell]()
        for target, cell in cells.items():
            stack, column = predicted.roster.places[f"{target}.location"]
            weighed = _weighed(predicted, target, self._likelihood(cell, cameras[target]), outside=0.0)
            if not weighed.sum() > 0:
                impossible[target] = cell
                continue
            if arrays[stack] is predicted.arrays[stack]:
                arrays[stack] = arrays[stack].copy()
            arrays[stack][:, column] = weighed / weighed.sum()
        return (predicted.with_arrays(arrays) if cells else predicted), impossible

    @staticmethod
    def unseen(
        predicted: ProductBelief, targets: Collection[str], missed: Float[np.ndarray, " cells"]
    ) -> ProductBelief:
        """A prediction weighed with not having been seen by cameras that look at no preset of their own.

        Columns no longer sum to one; one that sums to zero says that this, too, is impossible.

        Parameters
        ----------
        predicted : ProductBelief
        targets : collection of str
            Whom no camera saw.
        missed : (cells,) float
            Probability that these cameras miss a target in each free cell.
        """
        arrays = list(predicted.arrays)
        for target in targets:
            stack, column = predicted.roster.places[f"{target}.location"]
            if arrays[stack] is predicted.arrays[stack]:
                arrays[stack] = arrays[stack].copy()
            arrays[stack][:, column] = _weighed(predicted, target, missed, outside=1.0)
        return predicted.with_arrays(arrays)

    def _likelihood(self, cell: Cell, camera: str) -> Float[np.ndarray, " cells"]:
        """``P(reported cell | cell)``."""
        column = self._kernel(self._noise_m[camera])[:, [self._place.index(cell)]]
        return np.asarray(column.toarray().ravel())


def _weighed(
    belief: ProductBelief, target: str, likelihood: Float[np.ndarray, " cells"], outside: float
) -> Float[np.ndarray, " states"]:
    """A target's states times a likelihood of its cell; ``outside`` is that of being off the map."""
    stack, column = belief.roster.places[f"{target}.location"]
    places = belief.plan.stacks[stack].shape[0]
    of_places = np.pad(likelihood, (0, places - len(likelihood)), constant_values=outside)
    states = belief.arrays[stack][:, column].reshape(places, -1)
    return np.asarray((states * of_places[:, None]).ravel())
