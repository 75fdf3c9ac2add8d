"""How well a controller knows where the targets are: what decides a comparison before any preset is chosen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.control.base import Controller
from surveillance_domain.control.loop import Step, run_loop
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.experiments.runs import prepared_run
from surveillance_domain.experiments.setup import Case, surveillance_of
from surveillance_domain.model.build import Surveillance
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["knowledge"]


def knowledge(case: Case, number: int) -> float:
    """Share of target-steps, in one run, at which the controller places the target within one cell of where it is.

    Targets that are outside are left out.

    For ``pomdp`` that is the mass which its belief, after the sighting, puts on the true cell and its eight neighbours;
    for ``mp`` and ``msp`` whether the last sighting of this step (static cameras included for ``msp``) lies there.

    Raises
    ------
    ValueError
        For other controllers.
    """
    surveillance = surveillance_of(case.setup)
    world, controller = prepared_run(surveillance, case.controller, case.steps, case.seed, number, case.truth)
    place = _placed_by(case.controller, surveillance, controller)
    near = _near(surveillance.site.grid)
    shares: list[float] = []

    def weigh(step: Step) -> None:
        for target, cell in zip(surveillance.targets, world.truth.cells, strict=True):
            if cell == OUTSIDE:
                continue
            shares.append(float(place(step, target)[near(int(cell))].sum()))

    run_loop(world, controller, case.steps, weigh)
    return float(np.mean(shares))


Place = Callable[[Step, str], Float[np.ndarray, " cells"]]


def _placed_by(name: str, surveillance: Surveillance, controller: Controller) -> Place:
    """Where a controller places a target after a step."""
    grid = surveillance.site.grid
    if isinstance(controller, PomdpController):
        return lambda step, target: controller.belief.marginal(f"{target}.location")[: grid.size]
    if name not in ("mp", "msp"):
        raise ValueError(f"{name} places no targets; expected pomdp, mp or msp")

    def sighted(step: Step, target: str) -> Float[np.ndarray, " cells"]:
        cell = step.sighting.observations[target]
        if cell is None and name == "msp":
            cell = step.sighting.static.get(target)
        placed = np.zeros(grid.size)
        if cell is not None:
            placed[grid.number[cell[1], cell[0]]] = 1.0
        return placed

    return sighted


def _near(grid: Grid) -> Callable[[int], Bool[np.ndarray, " cells"]]:
    """A cell and its neighbours, as a mask over cells."""
    return lambda cell: np.asarray(np.abs(grid.cells - grid.cells[cell]).max(axis=1) <= 1)
