"""One simulated run, and many of them, with random numbers common to all controllers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.model.build import Surveillance, motion_parameters
from surveillance_domain.world.simulated import SimulatedWorld
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth

__all__ = ["Run", "TruthKind", "simulate_run", "simulate_runs", "simulated_world"]

TruthKind = Literal["grid", "continuous"]


@dataclass(frozen=True)
class Run:
    """What one run came to.

    Attributes
    ----------
    percent_obs : float
        In percent.
    decision_ms : tuple of float
        Each step's time for prediction, choice and conditioning.
    restarts : int
        Beliefs started anew because the model called the sighting impossible.
    """

    percent_obs: float
    decision_ms: tuple[float, ...]
    restarts: int


def simulated_world(surveillance: Surveillance, truth: TruthKind, seed: int, run: int) -> SimulatedWorld:
    """The world of one run; the same for every controller, and target k's motion the same for every number of targets."""
    for_truth, for_eyes = (np.random.default_rng(s) for s in np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2))
    kind = GridTruth if truth == "grid" else ContinuousTruth
    site = surveillance.site
    start = kind.initial(site.grid, motion_parameters(site), len(surveillance.targets), for_truth)
    return SimulatedWorld(surveillance, start, for_eyes)


def simulate_run(
    surveillance: Surveillance,
    controller: str,
    steps: int,
    seed: int,
    run: int,
    truth: TruthKind = "grid",
    each: Callable[[Step], None] | None = None,
) -> Run:
    """Let a controller run for some steps; run ``run`` of seed ``seed`` is the same world for every controller."""
    world = simulated_world(surveillance, truth, seed, run)
    chosen = make_controller(controller, surveillance, Setting(world, steps, run))
    record = run_loop(world, chosen, steps, each)
    return Run(percent_obs(record), tuple(step.decision_ms for step in record), chosen.restarts)


def simulate_runs(
    surveillance: Surveillance, controller: str, steps: int, runs: int, seed: int, truth: TruthKind = "grid"
) -> Iterator[Run]:
    """Runs one after the other, as they finish."""
    for run in range(runs):
        yield simulate_run(surveillance, controller, steps, seed, run, truth)
