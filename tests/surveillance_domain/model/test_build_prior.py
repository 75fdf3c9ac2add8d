"""The site's prior is where the model, and every kind of truth, has the targets before the first step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import starting_places, surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Door
from surveillance_domain.site.site import Site


def site_with_prior(*doors: Door) -> Site:
    """The site tiny, where targets are in cell 3 three times as often as in cell 7, and nowhere else."""
    site = load_site("tiny")
    prior = np.zeros(site.grid.size)
    prior[[3, 7]] = 0.75, 0.25
    return replace(site, prior=prior, targets=site.targets.model_copy(update={"doors": doors}))


@pytest.mark.example
def test_the_model_begins_with_the_prior() -> None:
    model = surveillance_model(site_with_prior(), 2).model
    for target in ("target1", "target2"):
        initial = model.initial[f"{target}.location"].dense().array
        assert np.flatnonzero(initial).tolist() == [3, 7]
        assert initial[[3, 7]].tolist() == [0.75, 0.25]


@pytest.mark.example
def test_with_doors_the_prior_is_of_those_inside() -> None:
    site = site_with_prior(Door(cells=((0, 0),), rate_per_s=0.1))
    initial = surveillance_model(site, 1).model.initial["target1.location"].dense().array
    assert 0 < initial[-1] < 1
    assert initial[[3, 7]] == pytest.approx([0.75 * (1 - initial[-1]), 0.25 * (1 - initial[-1])])
    assert starting_places(site, 0.2)[[3, 7, -1]] == pytest.approx([0.6, 0.2, 0.2])
    assert starting_places(load_site("micro"), None).tolist() == [0.25] * 4


@pytest.mark.example
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_simulated_targets_start_as_the_prior_says(truth: str) -> None:
    world = simulated_world(surveillance_model(site_with_prior(), 400), truth, 0, 0)
    cells, counts = np.unique(world.truth.cells, return_counts=True)
    assert cells.tolist() == [3, 7]
    assert counts[0] == pytest.approx(300, abs=35)  # four standard deviations


@pytest.mark.example
def test_emulated_targets_start_as_the_prior_says() -> None:
    with EmulatedSite(site_with_prior(), 20, VirtualClock(), np.random.default_rng(0)) as emulated:
        assert set(emulated.truth.cells.tolist()) <= {3, 7}
