"""The law of one target's move on the grid, enumerated pair by pair with scalar arithmetic.

It is the same law as the filter's tables (eq:targettransmodel with walls), written a second time and differently, so
that a mistake in one cannot hide in the other: nothing of the filter's motion code is imported.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import accumulate

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["GridChain", "Outcomes"]

NOTHING = 1e-12
SLIVER = 1e-9
REMEMBERED = 30_000


@dataclass(frozen=True)
class Outcomes:
    """What can come of one step, given cell, direction and next speed.

    Attributes
    ----------
    pairs : tuple of (next direction, next cell)
        The cell may be `OUTSIDE`.
    weights : tuple of float
        Their probabilities.
    cumulative : tuple of float
        Running sums of the weights, for drawing.
    """

    pairs: tuple[tuple[int, int], ...]
    weights: tuple[float, ...]
    cumulative: tuple[float, ...]

    @classmethod
    def of(cls, weighted: list[tuple[int, int, float]]) -> Outcomes:
        """Normalise triples of direction, cell and weight; triples without weight are left out."""
        kept = [triple for triple in weighted if triple[2] > 0]
        total = math.fsum(weight for _, _, weight in kept)
        weights = tuple(weight / total for _, _, weight in kept)
        return cls(tuple((direction, cell) for direction, cell, _ in kept), weights, tuple(accumulate(weights)))


Move = tuple[int | None, float]
"""Number of the cell a move leads to (or `OUTSIDE`, by a door), None where walls forbid it, and its share."""


@dataclass(frozen=True, eq=False)
class GridChain:
    """One target's motion on a map, asked for one state at a time and remembered.

    Attributes
    ----------
    grid : Grid
    parameters : MotionParameters
    """

    grid: Grid
    parameters: MotionParameters

    @cached_property
    def outcomes(self) -> Callable[[int, int, int], Outcomes]:
        """``outcomes(cell, direction, next speed)``: the law of (next direction, next cell)."""
        return lru_cache(REMEMBERED)(self._enumerate)

    @cached_property
    def moves(self) -> Callable[[int, int, int], list[Move]]:
        """``moves(cell, direction, speed)``: where the moved square's shares end."""
        return lru_cache(REMEMBERED)(self._moves)

    @cached_property
    def next_speeds(self) -> tuple[tuple[float, ...], ...]:
        """Running sums of P(v'|v) over v', for every v."""
        speeds, sigma = self.parameters.speeds_mps, self.parameters.sigma_speed_mps
        return tuple(tuple(accumulate(_speed_law(speeds, sigma, speed))) for speed in speeds)

    @cached_property
    def turn_weights(self) -> tuple[float, ...]:
        """P(d'|d) by the number of bins that the direction turns to the left."""
        bins, sigma = self.parameters.directions, self.parameters.sigma_direction_deg
        if sigma == 0 or bins == 1:
            return (1.0,) + (0.0,) * (bins - 1)
        width = 360.0 / bins
        turns = range(-math.ceil(10 * sigma / 360) - 1, math.ceil(10 * sigma / 360) + 2)
        return tuple(
            math.fsum(
                _normal_between(((k - 0.5) * width + 360 * turn) / sigma, ((k + 0.5) * width + 360 * turn) / sigma)
                for turn in turns
            )
            for k in range(bins)
        )

    @cached_property
    def door_cells(self) -> dict[tuple[int, int], float]:
        """Every door cell, with the rate at which a target that is outside comes in there."""
        return {cell: door.rate_per_s / len(door.cells) for door in self.parameters.doors for cell in door.cells}

    def _enumerate(self, cell: int, direction: int, speed: int) -> Outcomes:
        if cell == OUTSIDE:
            return self._entering(speed)
        moves = [self.moves(cell, heading, speed) for heading in range(self.parameters.directions)]
        if self.parameters.walls == "stay":
            return self._staying(cell, direction, moves)
        if self.parameters.walls == "reject":
            return self._rejecting(cell, direction, moves)
        return self._reflecting(cell, direction, moves)

    def _entering(self, speed: int) -> Outcomes:
        """Stay outside, or come in by a door; the heading is one that is open there, on the map."""
        rate = math.fsum(self.door_cells.values())
        staying_out = math.exp(-rate * self.parameters.step_s)
        headings = range(self.parameters.directions)
        arrivals: list[tuple[int, int, float]] = []
        for (column, row), own in self.door_cells.items():
            number = int(self.grid.number[row, column])
            share = own / rate if rate > 0 else 1 / (len(self.parameters.doors) * self._cells_beside(column, row))
            inwards = [
                math.fsum(
                    part for end, part in self.moves(number, heading, speed) if end is not None and end != OUTSIDE
                )
                for heading in headings
            ]
            if not any(inwards):
                inwards = [1.0] * len(inwards)
            arrivals += [(heading, number, share * inwards[heading] / math.fsum(inwards)) for heading in headings]
        outside = [
            (heading, OUTSIDE, staying_out * math.fsum(weight for other, _, weight in arrivals if other == heading))
            for heading in headings
        ]
        return Outcomes.of([(heading, end, (1 - staying_out) * weight) for heading, end, weight in arrivals] + outside)

    def _cells_beside(self, column: int, row: int) -> int:
        """How many cells the door of a cell has."""
        return next(len(door.cells) for door in self.parameters.doors if (column, row) in door.cells)

    def _staying(self, cell: int, direction: int, moves: list[list[Move]]) -> Outcomes:
        """Forbidden moves end in the cell they began in."""
        together: dict[tuple[int, int], float] = {}
        for heading, along in enumerate(moves):
            for end, share in along:
                pair = (heading, cell if end is None else end)
                together[pair] = together.get(pair, 0.0) + self._turning(direction, heading) * share
        return Outcomes.of([(*pair, weight) for pair, weight in together.items()])

    def _rejecting(self, cell: int, direction: int, moves: list[list[Move]]) -> Outcomes:
        """Forbidden moves are drawn again; where nothing in reach is open, the nearest headings that are open."""
        open_moves = [(heading, end, share) for heading, along in enumerate(moves) for end, share in _open(along)]
        in_reach = [(heading, end, self._turning(direction, heading) * share) for heading, end, share in open_moves]
        if math.fsum(weight for _, _, weight in in_reach) >= NOTHING:
            return Outcomes.of(in_reach)
        if not open_moves:
            return Outcomes.of([(direction, cell, 1.0)])
        least = min(self._apart(direction, heading) for heading, _, _ in open_moves)
        return Outcomes.of([move for move in open_moves if self._apart(direction, move[0]) == least])

    def _reflecting(self, cell: int, direction: int, moves: list[list[Move]]) -> Outcomes:
        """A heading whose moves away from the cell are all forbidden gives way to its nearest open mirror images."""
        leaving = [any(end != cell for end, _ in _open(along)) for along in moves]
        together: dict[tuple[int, int], float] = {}
        for drawn, along in enumerate(moves):
            headings = [drawn]
            if not leaving[drawn] and any(end != cell for end, _ in along):
                images = [image for image in self._images(drawn) if leaving[image]]
                least = min((self._apart(drawn, image) for image in images), default=0)
                headings = [image for image in images if self._apart(drawn, image) == least] or [drawn]
            ends = [(heading, end, share) for heading in headings for end, share in _open(moves[heading])]
            ends = ends or [(drawn, cell, 1.0)]
            total = math.fsum(share for _, _, share in ends)
            for heading, end, share in ends:
                weight = self._turning(direction, drawn) * share / total
                together[heading, end] = together.get((heading, end), 0.0) + weight
        return Outcomes.of([(*pair, weight) for pair, weight in together.items()])

    def _turning(self, direction: int, heading: int) -> float:
        return self.turn_weights[(heading - direction) % self.parameters.directions]

    def _apart(self, one: int, other: int) -> int:
        """Angle between two directions, in bins."""
        bins = self.parameters.directions
        return min((one - other) % bins, (other - one) % bins)

    def _images(self, heading: int) -> set[int]:
        """Bins nearest to a heading's three mirror images; two of them where an image lies midway."""
        bins = self.parameters.directions
        images = {(bins - heading) % bins}
        for twice in (bins - 2 * heading, bins + 2 * heading):  # twice the bin number of the image
            images |= {(twice // 2) % bins, ((twice + 1) // 2) % bins}
        return images

    def _moves(self, cell: int, heading: int, speed: int) -> list[Move]:
        """Share the moved square among the cells it overlaps, and ask for each whether the way there is open."""
        angle = 2 * math.pi * heading / self.parameters.directions
        length = self.parameters.speeds_mps[speed] * self.parameters.step_s / self.grid.cell_m
        x, y = length * math.cos(angle), length * math.sin(angle)
        column, row = (int(part) for part in self.grid.cells[cell])
        moves: list[Move] = []
        for dx in range(math.floor(x - SLIVER), math.ceil(x + SLIVER) + 1):
            for dy in range(math.floor(y - SLIVER), math.ceil(y + SLIVER) + 1):
                share_x, share_y = 1 - abs(x - dx), 1 - abs(y - dy)
                if share_x > SLIVER and share_y > SLIVER:
                    moves.append((self._end(column, row, dx, dy), share_x * share_y))
        return moves

    def _end(self, column: int, row: int, dx: int, dy: int) -> int | None:
        """Number of the cell at (dx, dy) from another, `OUTSIDE` by a door, or None if the way there is not open.

        The segment between the centres meets a cell's inside if no axis parts them: neither x nor y, nor the normal
        of the segment, on which a square is |dx| + |dy| wide. It touches cells where these are just parted: the two
        sides of a corner, which must not both be blocked. A way that leaves the map does so from the last cell that it
        meets there.
        """
        left: list[tuple[int, bool]] = []
        right: list[tuple[int, bool]] = []
        last = (0, column, row)
        for i in range(min(0, dx), max(0, dx) + 1):
            for j in range(min(0, dy), max(0, dy) + 1):
                x, y = column + i, row + j
                aside, on_map, free = 2 * (dx * j - dy * i), self._is_on_map(x, y), self._is_free(x, y)
                if abs(aside) < abs(dx) + abs(dy) and on_map:
                    if not free:
                        return None
                    last = max(last, (dx * i + dy * j, x, y))
                if aside != 0 and abs(aside) == abs(dx) + abs(dy):
                    (left if aside > 0 else right).append((abs(i), free or not on_map))
        for (_, one), (_, other) in zip(sorted(left), sorted(right), strict=True):
            if not (one or other):
                return None
        if self._is_on_map(column + dx, row + dy):
            return int(self.grid.number[row + dy, column + dx])
        return OUTSIDE if last[1:] in self.door_cells else None

    def _is_on_map(self, column: int, row: int) -> bool:
        return 0 <= row < self.grid.rows and 0 <= column < self.grid.columns

    def _is_free(self, column: int, row: int) -> bool:
        return self._is_on_map(column, row) and bool(self.grid.free[row, column])


def _open(moves: list[Move]) -> list[tuple[int, float]]:
    return [(end, share) for end, share in moves if end is not None]


def _speed_law(speeds: tuple[float, ...], sigma: float, speed: float) -> list[float]:
    """P(v'|v): the Gaussian's mass nearer to v' than to any other speed of the set."""
    if sigma == 0:
        return [float(other == speed) for other in speeds]
    law = []
    for candidate in speeds:
        slower = max((other for other in speeds if other < candidate), default=-math.inf)
        faster = min((other for other in speeds if other > candidate), default=math.inf)
        law.append(
            _normal_between(((slower + candidate) / 2 - speed) / sigma, ((candidate + faster) / 2 - speed) / sigma)
        )
    return law


def _normal_between(low: float, high: float) -> float:
    """Mass of the standard normal between two values."""
    if low > 0:
        low, high = -high, -low
    return 0.5 * (math.erfc(-high / math.sqrt(2)) - math.erfc(-low / math.sqrt(2)))
