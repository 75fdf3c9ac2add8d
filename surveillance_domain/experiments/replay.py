"""Cameras against recorded people: the loop of the simulation, with their positions as the truth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool

from surveillance_domain.control.base import Controller
from surveillance_domain.control.factory import Setting
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.experiments.runs import Run, run_of
from surveillance_domain.experiments.variants import make_variant
from surveillance_domain.model.build import Surveillance, motion_parameters, surveillance_model
from surveillance_domain.site.site import Site
from surveillance_domain.trajectories.staging import Stage
from surveillance_domain.world.simulated import SimulatedWorld
from surveillance_domain.world.truth import OUTSIDE
from surveillance_domain.world.truth_recorded import RecordedTruth

__all__ = ["Comings", "Replay", "Watched", "comings", "prepared_replay", "replay_run", "watched_replay"]


@dataclass(frozen=True)
class Replay:
    """A piece of a recording, ready to be watched: one target for each of its people."""

    surveillance: Surveillance
    world: SimulatedWorld
    controller: Controller
    steps: int


@dataclass(frozen=True)
class Comings:
    """How many people entered late and left early, and how many were there all the time."""

    late: int
    early: int
    throughout: int


def comings(stage: Stage) -> Comings:
    """Who of a piece is not on the map at its beginning, at its end, and who always is."""
    there = np.isfinite(stage.path_m[..., 0])
    return Comings(int((~there[0]).sum()), int((~there[-1]).sum()), int(there.all(axis=0).sum()))


def prepared_replay(site: Site, stage: Stage, controller: str, seed: int, run: int) -> Replay:
    """Model, world and controller before the first step; detections are the same for every controller.

    Raises
    ------
    ValueError
        For an unknown controller, or a site that lacks what it needs.
    """
    surveillance = surveillance_model(site, len(stage.people))
    _, for_eyes = (np.random.default_rng(s) for s in np.random.SeedSequence(seed, spawn_key=(run,)).spawn(2))
    truth = RecordedTruth(stage.path_m, site.grid, motion_parameters(site))
    world = SimulatedWorld(surveillance, truth, for_eyes)
    steps = len(stage.path_m) - 1
    return Replay(surveillance, world, make_variant(controller, surveillance, Setting(world, steps, run)), steps)


def replay_run(replay: Replay, each: Callable[[Step], None] | None = None) -> Run:
    """Watch it; ``each`` is told of every step when it is over."""
    return run_of(run_loop(replay.world, replay.controller, replay.steps, each), replay.controller)


@dataclass(frozen=True, eq=False)
class Watched:
    """A replay that is over, person by person.

    Attributes
    ----------
    run : Run
    present, seen : (steps, people) bool
        Whether somebody was on the map, and whether a camera saw them.
    """

    run: Run
    present: Bool[np.ndarray, "steps people"]
    seen: Bool[np.ndarray, "steps people"]

    @property
    def unmet(self) -> Bool[np.ndarray, "steps people"]:
        """Who is there and has not been seen by anybody so far."""
        return self.present & ~self._met

    @property
    def lost(self) -> Bool[np.ndarray, "steps people"]:
        """Who is there and not seen, but was before."""
        return self.present & ~self.seen & self._met

    @property
    def _met(self) -> Bool[np.ndarray, "steps people"]:
        return np.cumsum(self.seen, axis=0) > 0


def watched_replay(replay: Replay) -> Watched:
    """Watch a replay, and keep who was there and who was seen at every step."""
    present: list[np.ndarray] = []
    seen: list[list[bool]] = []

    def note(step: Step) -> None:
        present.append(replay.world.truth.cells != OUTSIDE)
        seen.append([step.sighting.observations[person] is not None for person in replay.surveillance.targets])

    run = replay_run(replay, note)
    return Watched(run, np.array(present), np.array(seen))
