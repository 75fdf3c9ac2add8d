"""The emulator's truth: stepped by its clock, whoever asks, and however often."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.emulation.moving_targets import MovingTargets
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.build import motion_parameters
from surveillance_domain.site.load import load_site
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth


@pytest.mark.example
@pytest.mark.parametrize("kind", [GridTruth, ContinuousTruth])
def test_truth_follows_the_clock(kind: type[GridTruth] | type[ContinuousTruth]) -> None:
    site = load_site("lego")
    truth = kind.initial(site.grid, motion_parameters(site), 4, np.random.default_rng(1))
    clock = VirtualClock(start_s=7.0)
    moving = MovingTargets(truth, site.control.step_s, site.targets.directions, clock, smooth=True)
    steps = [truth]
    for _ in range(20):
        steps.append(steps[-1].step())
    clock.sleep(5 * 1.5)
    np.testing.assert_array_equal(moving.truth.positions_m, steps[5].positions_m)
    clock.sleep(0.375)
    places, headings = moving.poses()
    between = 0.75 * steps[5].positions_m + 0.25 * steps[6].positions_m
    np.testing.assert_allclose(places, between, atol=1e-9)
    np.testing.assert_allclose(headings, steps[6].directions * np.pi / 4)
    clock.sleep(13 * 1.5)  # several steps at once
    np.testing.assert_array_equal(moving.truth.positions_m, steps[18].positions_m)


@pytest.mark.example
def test_targets_that_jump_stand_in_between() -> None:
    site = load_site("lego")
    truth = GridTruth.initial(site.grid, motion_parameters(site), 4, np.random.default_rng(1))
    clock = VirtualClock()
    moving = MovingTargets(truth, 1.5, 8, clock, smooth=False)
    clock.sleep(1.4)
    np.testing.assert_array_equal(moving.poses()[0], truth.positions_m)
    clock.sleep(0.1)
    np.testing.assert_array_equal(moving.poses()[0], truth.step().positions_m)
