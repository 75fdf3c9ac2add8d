"""One simulated run, with random numbers common to all controllers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from surveillance_domain.control.base import Controller
from surveillance_domain.control.factory import Setting
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.experiments.variants import make_variant
from surveillance_domain.model.build import Surveillance, motion_parameters
from surveillance_domain.world.simulated import SimulatedWorld
from surveillance_domain.world.truth import Truth
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth

__all__ = ["Run", "TruthKind", "prepared_run", "run_of", "simulate_run", "simulated_world"]

TruthKind = Literal["grid", "continuous"]
"""Whether targets move by the model's own chain, or in metres against the walls' geometry."""


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


def simulated_world(
    surveillance: Surveillance, truth: TruthKind, seed: int, run: int, start: Truth | None = None
) -> SimulatedWorld:
    """The world of one run, the same for every controller; target k moves the same for every number of targets.

    ``start`` is the targets' first state, from whoever remembers it.
    """
    for_truth, for_eyes = (np.random.default_rng(s) for s in np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2))
    if start is not None:
        return SimulatedWorld(surveillance, start, for_eyes)
    kind = GridTruth if truth == "grid" else ContinuousTruth
    site = surveillance.site
    prior = None
    if site.targets.doors or site.prior is not None:
        prior = surveillance.model.initial[f"{surveillance.targets[0]}.location"].dense().array
    start = kind.initial(site.grid, motion_parameters(site), len(surveillance.targets), for_truth, prior)
    return SimulatedWorld(surveillance, start, for_eyes)


def prepared_run(
    surveillance: Surveillance,
    controller: str,
    steps: int,
    seed: int,
    run: int,
    truth: TruthKind = "grid",
    start: Truth | None = None,
) -> tuple[SimulatedWorld, Controller]:
    """World and controller before the first step; run ``run`` of seed ``seed`` is the same world for every controller.

    Raises
    ------
    ValueError
        For an unknown controller, or a site that lacks what it needs.
    """
    world = simulated_world(surveillance, truth, seed, run, start)
    return world, make_variant(controller, surveillance, Setting(world, steps, run))


def simulate_run(
    surveillance: Surveillance,
    controller: str,
    steps: int,
    seed: int,
    run: int,
    truth: TruthKind = "grid",
    each: Callable[[Step], None] | None = None,
    start: Truth | None = None,
) -> Run:
    """Let a controller run for some steps; ``each`` is told of every step when it is over."""
    world, chosen = prepared_run(surveillance, controller, steps, seed, run, truth, start)
    return run_of(run_loop(world, chosen, steps, each), chosen)


def run_of(record: Sequence[Step], controller: Controller) -> Run:
    """What the steps of a run came to."""
    return Run(percent_obs(record), tuple(step.decision_ms for step in record), controller.restarts)
