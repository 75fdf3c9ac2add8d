"""Targets that move continuously, in metres, against the walls' geometry, as in the paper's simulator.

In one step the speed changes by N(0, σ_v) and is kept within the set's least and greatest (with one speed it is
constant), the heading by N(0, σ_d), and the target moves straight on for one step. Walls are the squares of blocked
cells and the map's edge. What becomes of a move that meets one:

``reject``
    The heading is drawn again, up to 200 times in all, until the move is open. After that the nearest open heading
    takes its place, searched outwards from the present one in steps of one degree, the sides in random order; where
    none is open the target stays, with its heading.
``stay``
    The target stops just before the wall and keeps its heading.
``reflect``
    The target is mirrored like a ball: the rest of the way is gone with the x or y component reversed, in a corner
    both, and the heading is mirrored with it.

With doors, a way that leaves the map from a door cell leads outside. In every step a target that is outside comes in
with probability 1 - exp(-Λ step_s), Λ being the sum of the doors' rates: at a door by its rate, anywhere in one of its
cells, with a heading drawn until the way of the next step is open and stays on the map (up to 200 times), and at the
speed that it had.

The belief stays on the grid, so that its misfit can show. Nothing of the filter's motion code is imported.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.straight_move import Wall, first_wall
from surveillance_domain.world.target_noise import TargetNoise
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["ContinuousTruth"]

TRIES = 200
SEARCH_DEG = 1.0
BEFORE_WALL_CELLS = 1e-6
BOUNCES = 50

Moved = tuple[float, float, float]
"""x and y, in cells from the map's lower-left corner, and the heading in radians."""


@dataclass(frozen=True, eq=False)
class ContinuousTruth:
    """True states of targets in metres at one time step.

    Attributes
    ----------
    positions_m : (targets, 2) float
        x and y in metres, always in a free cell; nan while the target is outside.
    headings_rad : (targets,) float
        Counter-clockwise from +x.
    speeds_mps : (targets,) float
        Metres a second.
    grid : Grid
    parameters : MotionParameters
    noise : TargetNoise
    time : int
        Steps since the beginning.
    """

    positions_m: Float[np.ndarray, "targets 2"]
    headings_rad: Float[np.ndarray, "targets"]
    speeds_mps: Float[np.ndarray, "targets"]
    grid: Grid
    parameters: MotionParameters
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
    ) -> ContinuousTruth:
        """Draw the targets' first states: positions uniform over the free area, or by ``prior`` over cells.

        Headings are uniform, speeds are drawn uniformly from the set. Under the same seed the targets start in the
        cells, directions and speeds of the truth on the grid.

        Parameters
        ----------
        grid : Grid
        parameters : MotionParameters
        targets : int
        rng : numpy.random.Generator
            Every target's random numbers are spawned from it; target k moves the same however many there are.
        prior : (cells,) or (cells + 1,) float, optional
            Weights of the free cells and, where there are doors, of being outside; they need not sum to one.

        Raises
        ------
        ValueError
            If ``targets`` is negative, the grid has no free cell, or the prior does not fit it.
        """
        noise = TargetNoise.spawn(targets, rng)
        draws = noise.initial(grid, parameters.directions, len(parameters.speeds_mps), prior)
        within = np.clip(draws.within, BEFORE_WALL_CELLS, 1 - BEFORE_WALL_CELLS)
        positions = (grid.cells[draws.cells] + within) * grid.cell_m + np.asarray(grid.origin_m)
        positions[draws.cells == OUTSIDE] = np.nan
        speeds = np.asarray(parameters.speeds_mps, dtype=float)[draws.speeds]
        return cls(positions, 2 * math.pi * draws.turn, speeds, grid, parameters, noise)

    @property
    def cells(self) -> Int[np.ndarray, "targets"]:
        """Number of the free cell each target is in, or `OUTSIDE`."""
        inside = np.isfinite(self.positions_m).all(axis=1)
        return np.where(inside, self.grid.number_at(np.where(inside[:, None], self.positions_m, 0.0)), OUTSIDE)

    @property
    def directions(self) -> Int[np.ndarray, "targets"]:
        """Direction bin nearest to each heading."""
        bins = self.parameters.directions
        return np.floor(self.headings_rad / (2 * math.pi) * bins + 0.5).astype(np.int64) % bins

    @property
    def speeds(self) -> Int[np.ndarray, "targets"]:
        """Index of the speed of the set that is nearest to each speed."""
        difference = np.abs(self.speeds_mps[:, None] - np.asarray(self.parameters.speeds_mps)[None, :])
        return difference.argmin(axis=1)

    def step(self) -> ContinuousTruth:
        """Change every target's speed and heading and move it straight on for one step."""
        positions, headings, speeds = self.positions_m.copy(), self.headings_rad.copy(), self.speeds_mps.copy()
        origin = np.asarray(self.grid.origin_m)
        slowest, fastest = min(self.parameters.speeds_mps), max(self.parameters.speeds_mps)
        for target in range(len(positions)):
            rng = self.noise.generator(target, self.time + 1)
            changed = speeds[target] + rng.normal(0.0, self.parameters.sigma_speed_mps)
            speeds[target] = min(max(changed, slowest), fastest)
            length = speeds[target] * self.parameters.step_s / self.grid.cell_m
            if np.isnan(positions[target, 0]):
                positions[target], headings[target] = self._entered(float(headings[target]), length, rng)
                continue
            x, y = ((positions[target] - origin) / self.grid.cell_m).tolist()
            x, y, headings[target] = self._moved(x, y, float(headings[target]), length, rng)
            positions[target] = np.array([x, y]) * self.grid.cell_m + origin  # nan stays nan
        return replace(self, positions_m=positions, headings_rad=headings, speeds_mps=speeds, time=self.time + 1)

    def _entered(
        self, heading: float, length: float, rng: np.random.Generator
    ) -> tuple[Float[np.ndarray, " 2"], float]:
        """Position (nan: still outside) and heading of a target that was outside."""
        rates = np.array([door.rate_per_s for door in self.parameters.doors])
        if rng.random() >= -math.expm1(-rates.sum() * self.parameters.step_s):
            return np.full(2, np.nan), heading
        cells = self.parameters.doors[rng.choice(len(rates), p=rates / rates.sum())].cells
        column, row = cells[rng.integers(len(cells))]
        x, y = np.array([column, row]) + np.clip(rng.random(2), BEFORE_WALL_CELLS, 1 - BEFORE_WALL_CELLS)
        for heading in (2 * math.pi * rng.random(TRIES)).tolist():
            dx, dy = length * math.cos(heading), length * math.sin(heading)
            if first_wall(self.grid.free, x, y, dx, dy) is None and self._holds(x + dx, y + dy):
                break
        return np.array([x, y]) * self.grid.cell_m + np.asarray(self.grid.origin_m), heading

    def _moved(self, x: float, y: float, heading: float, length: float, rng: np.random.Generator) -> Moved:
        sigma = math.radians(self.parameters.sigma_direction_deg)
        drawn = heading + rng.normal(0.0, sigma)
        if self._goes_out(x, y, drawn, length):
            return math.nan, math.nan, drawn
        if self._is_open(x, y, drawn, length):
            return x + length * math.cos(drawn), y + length * math.sin(drawn), drawn
        if self.parameters.walls == "reject":
            return self._rejecting(x, y, heading, length, rng)
        if self.parameters.walls == "stay":
            return self._stopping(x, y, drawn, length)
        return self._bouncing(x, y, drawn, length)

    def _rejecting(self, x: float, y: float, heading: float, length: float, rng: np.random.Generator) -> Moved:
        """Draw headings until the move is open, then search outwards for one that is."""
        drawn = heading + rng.normal(0.0, math.radians(self.parameters.sigma_direction_deg), size=TRIES - 1)
        side = 1 if rng.random() < 0.5 else -1
        turns = np.arange(0.0, 180.0 + SEARCH_DEG, SEARCH_DEG)
        searched = heading + np.radians(np.stack([side * turns, -side * turns], axis=1)).ravel()
        tried = np.concatenate([drawn, searched]) if self.parameters.sigma_direction_deg > 0 else searched
        ends = np.stack([x + length * np.cos(tried), y + length * np.sin(tried)], axis=1)
        ends_m = ends * self.grid.cell_m + np.asarray(self.grid.origin_m)
        possible = self.grid.number_at(ends_m) >= 0
        if any(max(abs(x - column - 0.5), abs(y - row - 0.5)) <= length + 0.5 for column, row in self._door_cells):
            column, row = self.grid.cell_at(ends_m).T
            possible |= (column < 0) | (column >= self.grid.columns) | (row < 0) | (row >= self.grid.rows)
        for candidate in tried[possible].tolist():
            if self._goes_out(x, y, candidate, length):
                return math.nan, math.nan, candidate
            if self._is_open(x, y, candidate, length):
                return x + length * math.cos(candidate), y + length * math.sin(candidate), candidate
        return x, y, heading

    def _stopping(self, x: float, y: float, heading: float, length: float) -> Moved:
        """Go up to the wall."""
        dx, dy = length * math.cos(heading), length * math.sin(heading)
        wall = first_wall(self.grid.free, x, y, dx, dy)
        share = max(0.0, wall.share - BEFORE_WALL_CELLS / length) if wall else 0.0
        end = (x + share * dx, y + share * dy)
        return (*(end if self._holds(*end) else (x, y)), heading)

    def _bouncing(self, x: float, y: float, heading: float, length: float) -> Moved:
        """Go the whole length, mirrored on every wall that is met; a target caught in a corner stops there."""
        dx, dy = length * math.cos(heading), length * math.sin(heading)
        for _ in range(BOUNCES):
            wall = first_wall(self.grid.free, x, y, dx, dy)
            if wall is not None and self._is_door(wall):
                return math.nan, math.nan, heading
            share = 1.0 if wall is None else max(0.0, wall.share - BEFORE_WALL_CELLS / math.hypot(dx, dy))
            end = (x + share * dx, y + share * dy)
            if not self._holds(*end):
                break
            x, y = end
            if wall is None:
                break
            rest = 1 - wall.share
            dx, dy = rest * (-dx if wall.stops_x else dx), rest * (-dy if wall.stops_y else dy)
            heading = math.atan2(
                -math.sin(heading) if wall.stops_y else math.sin(heading),
                -math.cos(heading) if wall.stops_x else math.cos(heading),
            )
            if math.hypot(dx, dy) < BEFORE_WALL_CELLS:
                break
        return x, y, heading

    def _goes_out(self, x: float, y: float, heading: float, length: float) -> bool:
        """Whether the straight way leaves the map from a door cell."""
        if not self.parameters.doors:
            return False
        dx, dy = length * math.cos(heading), length * math.sin(heading)
        wall = first_wall(self.grid.free, x, y, dx, dy)
        return wall is not None and self._is_door(wall)

    def _is_door(self, wall: Wall) -> bool:
        return wall.at_edge and wall.cell in self._door_cells

    @cached_property
    def _door_cells(self) -> frozenset[tuple[int, int]]:
        return frozenset(cell for door in self.parameters.doors for cell in door.cells)

    def _is_open(self, x: float, y: float, heading: float, length: float) -> bool:
        dx, dy = length * math.cos(heading), length * math.sin(heading)
        return first_wall(self.grid.free, x, y, dx, dy) is None and self._holds(x + dx, y + dy)

    def _holds(self, x: float, y: float) -> bool:
        """Whether a point, once written in metres, lies in a free cell."""
        size, (origin_x, origin_y) = self.grid.cell_m, self.grid.origin_m
        column = math.floor(((x * size + origin_x) - origin_x) / size)
        row = math.floor(((y * size + origin_y) - origin_y) / size)
        return 0 <= row < self.grid.rows and 0 <= column < self.grid.columns and bool(self.grid.free[row, column])
