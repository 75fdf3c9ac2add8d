"""Emulated targets come and go where the site has doors: in the truth, in pictures, in what is counted."""

from __future__ import annotations

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.commands.network import network_of
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.control.watch import Watch
from surveillance_domain.emulation.moving_targets import MovingTargets
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.build import motion_parameters, surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Door
from surveillance_domain.site.site import Site
from surveillance_domain.world.truth import OUTSIDE
from surveillance_domain.world.truth_continuous import ContinuousTruth

LEGO = load_site("lego")


def with_doors(rate_per_s: float = 0.1) -> Site:
    """The arena with a wide door in its lower edge and one in its upper."""
    doors = tuple(Door(cells=tuple((c, row) for c in range(3, 7)), rate_per_s=rate_per_s) for row in (0, 7))
    return replace(LEGO, targets=LEGO.targets.model_copy(update={"doors": doors}))


@pytest.mark.example
def test_as_many_begin_outside_as_the_model_expects() -> None:
    site = replace(with_doors(), markers=None)  # there are not enough markers for a crowd
    prior = surveillance_model(site, 1).model.initial["red.location"].dense().array
    with EmulatedSite(site, 400, VirtualClock(), np.random.default_rng(0)) as emulation:
        outside = (emulation.truth.cells == OUTSIDE).mean()
    assert prior[-1] > 0.1
    assert outside == pytest.approx(prior[-1], abs=0.07)  # three standard deviations of 400 draws
    with EmulatedSite(replace(LEGO, markers=None), 400, VirtualClock(), np.random.default_rng(0)) as emulation:
        assert (emulation.truth.cells != OUTSIDE).all()


@pytest.mark.example
def test_who_leaves_stands_in_the_door_until_the_step_is_over() -> None:
    site, clock = with_doors(), VirtualClock()
    start = ContinuousTruth.initial(site.grid, motion_parameters(site), 6, np.random.default_rng(2))
    moving = MovingTargets(start, 1.5, 8, clock, smooth=True)
    left = came = 0
    truth = start
    for _ in range(60):
        after = truth.step()
        np.testing.assert_array_equal(moving.poses()[0], truth.positions_m)
        clock.sleep(0.75)
        places = moving.poses()[0]
        leaves = (truth.cells != OUTSIDE) & (after.cells == OUTSIDE)
        enters = (truth.cells == OUTSIDE) & (after.cells != OUTSIDE)
        np.testing.assert_array_equal(places[leaves], truth.positions_m[leaves])
        assert np.isnan(places[enters]).all()
        left, came, truth = left + leaves.sum(), came + enters.sum(), after
        clock.sleep(0.75)
    assert left > 5 < came


@pytest.mark.end_to_end
@pytest.mark.parametrize("pictures", [True, False])
def test_only_those_who_are_there_are_seen_and_counted(pictures: bool) -> None:
    present = []
    shares = []
    with network_of(with_doors(), 4, emulated=True, seed=3, virtual=True, pictures=pictures) as network:
        assert network.world.start(10.0) == {}
        assert network.truth is not None
        controller = make_controller("pomdp", network.surveillance, Setting())
        watch = Watch(network.world, controller, truth=network.truth)
        for step in islice(watch.turns(), 8 if pictures else 30):
            there = network.truth().cells != OUTSIDE
            seen = [step.sighting.observations[target] is not None for target in network.surveillance.targets]
            assert not (np.array(seen) & ~there).any()
            present.append(int(there.sum()))
            shares.append(replace(step, truly_present=int(there.sum())))
        assert watch.summary()["percent_obs"] == pytest.approx(percent_obs(shares))
    assert len(set(present)) > 1
