"""The confusion kernel: which cell a detection reports when its true cell is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from surveillance_domain.site.grid import Grid

if TYPE_CHECKING:
    from scipy.sparse import csr_array

__all__ = ["confusion_kernel"]

_CUT_SIGMAS = 3.0
_MOST_ENTRIES = 50_000_000


def confusion_kernel(grid: Grid, noise_m: float) -> csr_array:
    """``P(reported cell | true cell)``, a sparse (cells, cells) matrix whose rows sum to one.

    A Gaussian of standard deviation ``noise_m`` (metres) about the true cell's centre is integrated over the square of
    each free cell whose centre is at most three standard deviations away (model.md, "Imperfect eyes"), and what falls
    on them is renormalised. The identity for ``noise_m = 0``. Walls do not matter: an error in the picture knows none.

    Raises
    ------
    ValueError
        If ``noise_m`` is negative or not finite, or so large that the matrix would have over 50 million entries.
    """
    from scipy.sparse import csr_array, identity

    if not 0 <= noise_m < np.inf:
        raise ValueError(f"cell noise: found {noise_m:g} m; expected 0 or more")
    if noise_m == 0:
        return csr_array(identity(grid.size, format="csr"))
    reach = int(min(_CUT_SIGMAS * noise_m / grid.cell_m + 1e-9, max(grid.rows, grid.columns)))
    share = _share_by_offset(reach, grid.cell_m / noise_m)
    offsets = np.arange(-reach, reach + 1)
    near = np.hypot(*np.meshgrid(offsets, offsets)) * grid.cell_m <= _CUT_SIGMAS * noise_m + 1e-9
    entries = int(near.sum()) * grid.size
    if entries > _MOST_ENTRIES:
        raise ValueError(
            f"cell noise of {noise_m:g} m on cells of {grid.cell_m:g} m: up to {entries:,} entries; "
            f"expected at most {_MOST_ENTRIES:,}: less noise or larger cells"
        )
    numbers = np.pad(grid.number, reach, constant_values=-1)
    column, row = grid.cells.T
    true, reported, weight = [], [], []
    for dy, dx in zip(*(index - reach for index in np.nonzero(near)), strict=True):
        neighbour = numbers[row + reach + dy, column + reach + dx]
        there = np.flatnonzero(neighbour >= 0)
        true.append(there)
        reported.append(neighbour[there])
        weight.append(np.full(len(there), share[dy + reach] * share[dx + reach]))
    entry = (np.concatenate(true), np.concatenate(reported))
    kernel = csr_array((np.concatenate(weight), entry), shape=(grid.size, grid.size))
    kernel.data /= np.repeat(kernel.sum(axis=1), np.diff(kernel.indptr))
    return kernel


def _share_by_offset(reach: int, cell_in_sigmas: float) -> Float[np.ndarray, " offsets"]:
    """Mass of a standard Gaussian about a cell's centre in the cells ``-reach … reach`` along one axis."""
    from scipy.special import ndtr

    edges = (np.arange(-reach, reach + 2) - 0.5) * cell_in_sigmas
    # The upper tail is taken from the lower one, where differences are exact.
    return np.where(edges[:-1] > 0, ndtr(-edges[:-1]) - ndtr(-edges[1:]), ndtr(edges[1:]) - ndtr(edges[:-1]))
