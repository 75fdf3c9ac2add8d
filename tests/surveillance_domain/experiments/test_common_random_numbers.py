"""What makes comparisons fair: run r is the same world for every controller and every number of targets."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from surveillance_domain.control.loop import run_loop
from surveillance_domain.experiments.runs import TruthKind, prepared_run, simulate_run
from surveillance_domain.experiments.setup import Setup, surveillance_of
from surveillance_domain.world.base import Sighting

STEPS = 15


def walk(controller: str, targets: int, truth: TruthKind, run: int = 0) -> tuple[np.ndarray, list[Sighting]]:
    """Positions of all targets after every step, and what was seen."""
    surveillance = surveillance_of(Setup("tiny", targets, detection_probability=0.7, cell_noise_m=0.4))
    world, chosen = prepared_run(surveillance, controller, STEPS, 5, run, truth)
    positions: list[np.ndarray] = []
    record = run_loop(world, chosen, STEPS, lambda step: positions.append(np.array(world.truth.positions_m)))
    return np.array(positions), [step.sighting for step in record]


@pytest.mark.end_to_end
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_targets_move_the_same_for_every_controller_and_number_of_targets(truth: TruthKind) -> None:
    few, _ = walk("pomdp", 2, truth)
    for controller in ("sys", "mp-hold", "clairvoyant"):
        many, _ = walk(controller, 4, truth)
        np.testing.assert_array_equal(many[:, :2], few)
    assert not np.array_equal(walk("pomdp", 2, truth, run=1)[0], few)


@pytest.mark.end_to_end
def test_the_luck_of_the_cameras_is_the_same_where_their_presets_are() -> None:
    def told(sightings: Sequence[Sighting], target: str) -> list[object]:
        return [(sighting.observations[target], sighting.static[target]) for sighting in sightings]

    _, few = walk("sys", 1, "grid")
    _, many = walk("sys", 3, "grid")
    assert told(few, "target1") == told(many, "target1")
    _, held = walk("mp-hold", 1, "grid")
    _, dropped = walk("mp", 1, "grid")
    assert [sighting.static for sighting in held] == [sighting.static for sighting in dropped]
    pairs = [(a.observations, b.observations) for a, b in zip(held, dropped, strict=True) if a.views == b.views]
    assert len(pairs) > 3
    assert all(ours == theirs for ours, theirs in pairs)


@pytest.mark.end_to_end
def test_a_run_can_be_repeated() -> None:
    surveillance = surveillance_of(Setup("tiny", 3))
    first, second = (simulate_run(surveillance, "pomdp", STEPS, 9, 2, "continuous") for _ in range(2))
    assert (first.percent_obs, first.restarts) == (second.percent_obs, second.restarts)
