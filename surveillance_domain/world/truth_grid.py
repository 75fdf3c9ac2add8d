"""Targets that move by the model's own chain on the grid, so that the model's bounds hold of them."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.grid_chain import GridChain
from surveillance_domain.world.target_noise import TargetNoise
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["GridTruth"]


@dataclass(frozen=True, eq=False)
class GridTruth:
    """True states of targets on the grid at one time step.

    Attributes
    ----------
    cells, directions, speeds : (targets,) int
        Number of the free cell (or `OUTSIDE`), direction bin and index of the speed.
    chain : GridChain
        The law they move by; shared by successive states, with what it remembers.
    noise : TargetNoise
    time : int
        Steps since the beginning.
    """

    cells: Int[np.ndarray, "targets"]
    directions: Int[np.ndarray, "targets"]
    speeds: Int[np.ndarray, "targets"]
    chain: GridChain
    noise: TargetNoise
    time: int = 0

    @classmethod
    def initial(
        cls,
        grid: Grid,
        parameters: MotionParameters,
        targets: int,
        rng: np.random.Generator,
        prior: Float[np.ndarray, "places"] | None = None,
    ) -> GridTruth:
        """Draw the targets' first states: cells by ``prior`` (default: uniform), directions and speeds uniformly.

        Parameters
        ----------
        grid : Grid
        parameters : MotionParameters
        targets : int
        rng : numpy.random.Generator
            Every target's random numbers are spawned from it; a fresh one with the same seed gives the same motion,
            and target k moves the same however many targets there are.
        prior : (cells,) or (cells + 1,) float, optional
            Weights of the free cells and, where there are doors, of being outside; they need not sum to one.

        Raises
        ------
        ValueError
            If ``targets`` is negative, the grid has no free cell, or the prior does not fit it.
        """
        noise = TargetNoise.spawn(targets, rng)
        draws = noise.initial(grid, parameters.directions, len(parameters.speeds_mps), prior)
        bins = np.floor(draws.turn * parameters.directions + 0.5).astype(np.int64) % parameters.directions
        return cls(draws.cells, bins, draws.speeds, GridChain(grid, parameters), noise)

    @property
    def positions_m(self) -> Float[np.ndarray, "targets 2"]:
        """Centres of the targets' cells, x and y in metres; nan outside."""
        return np.where((self.cells == OUTSIDE)[:, None], np.nan, self.chain.grid.centres_m[self.cells])

    def step(self) -> GridTruth:
        """Move every target by one draw from P(v'|v) and one from P(d'|d,l,v') P(l'|l,d',v')."""
        cells, directions, speeds = self.cells.copy(), self.directions.copy(), self.speeds.copy()
        for target, (for_speed, for_move) in enumerate(self.noise.uniforms(self.time).tolist()):
            speeds[target] = _drawn(self.chain.next_speeds[speeds[target]], for_speed)
            outcomes = self.chain.outcomes(int(cells[target]), int(directions[target]), int(speeds[target]))
            directions[target], cells[target] = outcomes.pairs[_drawn(outcomes.cumulative, for_move)]
        return replace(self, cells=cells, directions=directions, speeds=speeds, time=self.time + 1)


def _drawn(cumulative: tuple[float, ...], uniform: float) -> int:
    """Index drawn by a uniform number from running sums; these may end a rounding error away from one."""
    return bisect_right(cumulative, uniform * cumulative[-1], hi=len(cumulative) - 1)
