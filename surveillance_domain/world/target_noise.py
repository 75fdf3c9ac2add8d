"""Common random numbers: every target has its own noise, and every step of it too.

What target k draws at step t depends on the seed, k and t alone: not on how many other targets there are, what they
did, or how often a truth is stepped from the same state. So controllers and numbers of targets are compared on the
same motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.site.grid import Grid
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["InitialDraws", "TargetNoise"]

BLOCK_STEPS = 64
INITIAL, STEPS, BLOCKS = range(3)


@dataclass(frozen=True, eq=False)
class InitialDraws:
    """Where the targets start, the same for every kind of truth under one seed.

    Attributes
    ----------
    cells : (targets,) int
        Number of a free cell, or `OUTSIDE`.
    within : (targets, 2) float
        Position in the cell, in cells from its lower-left corner, in [0, 1).
    turn : (targets,) float
        Heading as a share of the full turn, counter-clockwise from +x, in [0, 1).
    speeds : (targets,) int
        Index into the set of speeds.
    """

    cells: Int[np.ndarray, "targets"]
    within: Float[np.ndarray, "targets 2"]
    turn: Float[np.ndarray, "targets"]
    speeds: Int[np.ndarray, "targets"]


@dataclass(frozen=True, eq=False)
class TargetNoise:
    """One source of random numbers a target, and from it one generator a step.

    Attributes
    ----------
    sources : tuple of numpy.random.SeedSequence
        One a target.
    """

    sources: tuple[np.random.SeedSequence, ...]
    _blocks: dict[int, Float[np.ndarray, "targets steps 2"]] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def spawn(cls, targets: int, rng: np.random.Generator) -> TargetNoise:
        """Split sources for ``targets`` targets off a generator; the first ones do not depend on how many follow."""
        if targets < 0:
            raise ValueError(f"targets is {targets}, must not be negative")
        seed = rng.bit_generator.seed_seq
        if not isinstance(seed, np.random.SeedSequence):
            raise ValueError("rng was not made from a seed: make it with numpy.random.default_rng(seed)")
        return cls(tuple(seed.spawn(targets)))

    def __len__(self) -> int:
        return len(self.sources)

    def generator(self, target: int, step: int) -> np.random.Generator:
        """Make the generator of a target's noise at a step, always from its beginning."""
        return self._generator(target, STEPS, step)

    def uniforms(self, step: int) -> Float[np.ndarray, "targets 2"]:
        """Two uniform numbers for every target at a step; drawn in blocks of steps, the last of which is remembered."""
        block, within = divmod(step, BLOCK_STEPS)
        if block not in self._blocks:
            draws = [self._generator(target, BLOCKS, block).random((BLOCK_STEPS, 2)) for target in range(len(self))]
            self._blocks.clear()
            self._blocks[block] = np.array(draws).reshape(-1, BLOCK_STEPS, 2)
        return self._blocks[block][:, within]

    def initial(
        self, grid: Grid, directions: int, speeds: int, prior: Float[np.ndarray, "places"] | None = None
    ) -> InitialDraws:
        """Draw the states at step 0: cells by ``prior`` (default: uniform), all else uniform.

        Headings are drawn such that the direction bins, which are centred at multiples of 360 / directions degrees,
        are equally likely. A weight after those of the cells is that of being outside.

        Raises
        ------
        ValueError
            If the grid has no free cell, or the prior is no weight for each of its free cells.
        """
        cumulative = np.cumsum(_checked(grid, prior))
        cumulative /= cumulative[-1]
        draws = np.array([self._generator(target, INITIAL).random(5) for target in range(len(self))]).reshape(-1, 5)
        places = np.searchsorted(cumulative, draws[:, 0], side="right")
        return InitialDraws(
            cells=np.where(places < grid.size, places, OUTSIDE),
            within=draws[:, 1:3],
            turn=(draws[:, 3] - 0.5 / directions) % 1.0,
            speeds=np.floor(draws[:, 4] * speeds).astype(np.int64),
        )

    def _generator(self, target: int, *purpose: int) -> np.random.Generator:
        source = self.sources[target]
        return np.random.default_rng(np.random.SeedSequence(source.entropy, spawn_key=(*source.spawn_key, *purpose)))


def _checked(grid: Grid, prior: Float[np.ndarray, "weights"] | None) -> Float[np.ndarray, "places"]:
    """Return the weights of the free cells (and of outside), or raise with what is wrong about them."""
    if grid.size == 0:
        raise ValueError("the grid has no free cell: targets have nowhere to be; free at least one cell of the map")
    weights = np.ones(grid.size) if prior is None else np.asarray(prior, dtype=float)
    if weights.shape not in ((grid.size,), (grid.size + 1,)):
        raise ValueError(f"prior has shape {weights.shape}, must hold one weight for each of {grid.size} free cells")
    if not (np.isfinite(weights).all() and (weights >= 0).all() and weights.sum() > 0):
        raise ValueError("prior: weights must be finite and not negative, and one of them positive")
    return weights
