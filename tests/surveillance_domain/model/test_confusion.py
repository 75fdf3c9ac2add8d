"""The confusion kernel against hand-computed numbers and numerical integration."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from surveillance_domain.model.confusion import confusion_kernel
from surveillance_domain.site.grid import Grid


@pytest.mark.example
def test_without_noise_it_is_the_identity() -> None:
    assert confusion_kernel(Grid.from_rows(["..#", "..."], 1.0), 0.0).toarray().tolist() == np.eye(5).tolist()


@pytest.mark.example
def test_two_cells_side_by_side() -> None:
    # sigma = 1 cell: mass of the own cell's width 0.38292, of the neighbour's 0.24173; the height cancels.
    kernel = confusion_kernel(Grid.from_rows([".."], 0.5), 0.5).toarray()
    assert kernel[0] == pytest.approx([0.38292 / 0.62465, 0.24173 / 0.62465], abs=1e-4)


@pytest.mark.example
def test_it_is_cut_at_three_sigma_between_centres() -> None:
    row = confusion_kernel(Grid.from_rows(["." * 9], 1.0), 1.0).toarray()[4]
    assert (row > 0).tolist() == [False, True, True, True, True, True, True, True, False]
    tiny_noise = confusion_kernel(Grid.from_rows(["..."], 1.0), 0.1).toarray()
    assert tiny_noise.tolist() == np.eye(3).tolist()


@pytest.mark.property
@given(
    free=arrays.arrays(np.bool_, st.tuples(st.integers(1, 6), st.integers(1, 6)), elements=st.booleans()),
    cell_m=st.sampled_from([0.3, 1.0]),
    noise_cells=st.floats(0.05, 4.0),
)
def test_it_is_the_renormalised_integral_over_free_cells(free: np.ndarray, cell_m: float, noise_cells: float) -> None:
    grid = Grid(free, cell_m, (3.0, -2.0))
    noise_m = noise_cells * cell_m
    kernel = confusion_kernel(grid, noise_m).toarray()
    for true in range(grid.size):
        weights = []
        for reported in range(grid.size):
            offset = grid.centres_m[reported] - grid.centres_m[true]
            mass = math.prod(
                0.5
                * (
                    math.erf((along + cell_m / 2) / noise_m / math.sqrt(2))
                    - math.erf((along - cell_m / 2) / noise_m / math.sqrt(2))
                )
                for along in offset.tolist()
            )
            weights.append(mass if math.hypot(*offset) <= 3 * noise_m + 1e-9 else 0.0)
        assert kernel[true] == pytest.approx(np.array(weights) / sum(weights), abs=1e-12)


@pytest.mark.example
@pytest.mark.parametrize("noise_m", [-1.0, math.nan, math.inf])
def test_noise_must_be_a_length(noise_m: float) -> None:
    with pytest.raises(ValueError, match="cell noise"):
        confusion_kernel(Grid.from_rows(["."], 1.0), noise_m)


@pytest.mark.example
def test_a_kernel_that_would_not_fit_is_refused_before_it_is_made() -> None:
    with pytest.raises(ValueError, match=r"up to .* entries"):
        confusion_kernel(Grid(np.ones((300, 300), dtype=bool), 0.1), 3.0)
