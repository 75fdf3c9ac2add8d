"""RockSample(n, k): a rover on a map with rocks, some of which are worth sampling; a look from far away is unreliable.

Source: Smith and Simmons, "Heuristic search value iteration for POMDPs", UAI 2004. The maps of (4,4), (5,5), (5,7),
(7,8) and (11,11), and the sensor of each, are those of the files that are compared in the literature; other maps are
drawn from ``seed``. There a step over the edge, or sampling where no rock is, ends the run at a cost of 100; here it is
not legal.
"""

from __future__ import annotations

import math

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.specification import table
from factored_pomdp.variables import Variable

__all__ = ["rocksample"]

Cell = tuple[int, int]
Place = Cell | str

_MAPS: dict[tuple[int, int], list[Cell]] = {
    (4, 4): [(3, 1), (2, 1), (1, 3), (1, 0)],
    (5, 5): [(2, 4), (0, 4), (3, 3), (2, 2), (4, 1)],
    (5, 7): [(1, 0), (2, 1), (1, 2), (2, 2), (4, 2), (0, 3), (3, 4)],
    (7, 8): [(2, 0), (0, 1), (3, 1), (6, 3), (2, 4), (3, 4), (5, 5), (1, 6)],
    (11, 11): [(0, 3), (0, 7), (1, 8), (2, 4), (3, 3), (3, 8), (4, 3), (5, 8), (6, 1), (9, 3), (9, 9)],
}
_HALF_EFFICIENCY = {(4, 4): math.log(2), (5, 5): 4.0}
_USUAL_HALF_EFFICIENCY = 20.0
_MOVES = {"north": (0, 1), "east": (1, 0), "south": (0, -1), "west": (-1, 0)}
_OUTSIDE = "outside"
_MOST_ROCKS = 11
_MOST_COLUMNS = 100


def rocksample(
    n: int = 4, k: int = 4, seed: int | None = None, half_efficiency: float | None = None, discount: float = 0.95
) -> FactoredPOMDP:
    """A rover that looks for good rocks and leaves to the east.

    Parameters
    ----------
    n : int
        Columns and rows of the map, from 2 to 100.
    k : int
        Rocks, from 1 to 11, and no more than cells.
    seed : int, optional
        Draws the map; where left out, the published map of that size, else that of seed 0.
    half_efficiency : float, optional
        Distance in cells from which a check is right with probability 3/4; where left out, the published one of that
        size (ln 2 for (4,4), 4 for (5,5), else 20).
    discount : float
    """
    most = min(_MOST_ROCKS, n * n) if n >= 2 else _MOST_ROCKS
    wrong = [] if 2 <= n <= _MOST_COLUMNS else [f"n={n}: expected 2 to {_MOST_COLUMNS}"]
    wrong += [f"k={k}: expected 1 to {most} rocks"] if not 1 <= k <= most else []
    if half_efficiency is None:
        half_efficiency = _HALF_EFFICIENCY.get((n, k), _USUAL_HALF_EFFICIENCY)
    wrong += [f"half_efficiency={half_efficiency}: expected a distance above 0"] if not half_efficiency > 0 else []
    if wrong:
        raise ValueError("; ".join(wrong))
    cells = _MAPS[n, k] if seed is None and (n, k) in _MAPS else _drawn(n, k, seed or 0)
    places: list[Place] = [*((x, y) for y in range(n) for x in range(n)), _OUTSIDE]
    rocks = {f"rock{number}": cell for number, cell in enumerate(cells, 1)}
    checks = {f"check {rock}": rock for rock in rocks}

    def move(place: Place, act: str) -> Place:
        if not isinstance(place, tuple) or act not in _MOVES:
            return place
        to = place[0] + _MOVES[act][0], place[1] + _MOVES[act][1]
        return _OUTSIDE if to[0] == n else to if min(to) >= 0 and to[1] < n else place

    def may(place: Place, act: str) -> bool:
        if not isinstance(place, tuple) or act in checks:
            return True
        return place in cells if act == "sample" else move(place, act) != place

    def left(place: Place, act: str) -> float:
        return 10.0 * (place != _OUTSIDE and move(place, act) == _OUTSIDE)

    def sampled(rock: str) -> tuple[object, object]:
        def after(place: Place, act: str, worth: str) -> str:
            return "bad" if act == "sample" and place == rocks[rock] else worth

        def gain(place: Place, act: str, worth: str) -> float:
            return (10.0 if worth == "good" else -10.0) * (act == "sample" and place == rocks[rock])

        return after, gain

    acts = [*_MOVES, "sample", *checks]
    ways = {rock: sampled(rock) for rock in rocks}
    return FactoredPOMDP(
        name=f"rocksample-{n}-{k}",
        states=[Variable("place", places), *(Variable(rock, ["good", "bad"]) for rock in rocks)],
        actions=[Variable("act", acts)],
        observations=[Variable("reading", ["good", "bad", "nothing"])],
        transition={
            "place": move,
            **{rock: table("place", "act", rock, f"{rock}.next", values=after) for rock, (after, _) in ways.items()},
        },
        observation={
            "reading": table(
                "act",
                "place.next",
                *(f"{rock}.next" for rock in rocks),
                "reading",
                values=_readings(places, cells, half_efficiency),
            )
        },
        reward={
            "leave": left,
            **{f"sample {rock}": table("place", "act", rock, values=gain) for rock, (_, gain) in ways.items()},
        },
        initial={"place": (0, n // 2), **{rock: {"good": 0.5, "bad": 0.5} for rock in rocks}},
        legal={"act": may},
        terminal=lambda place: float(place == _OUTSIDE),
        discount=discount,
    )


def _readings(places: list[Place], cells: list[Cell], half_efficiency: float) -> np.ndarray:
    """P(reading | act, place, rocks): right with ``(1 + 2^(-distance / half efficiency)) / 2``; axes in that order."""
    inside = np.array(places[:-1], dtype=float)
    found = np.zeros([5 + len(cells), len(places), *[2] * len(cells), 3])
    found[:5, ..., 2] = 1.0
    for number, cell in enumerate(cells):
        distance = np.append(np.hypot(*(inside - cell).T), np.inf)
        right = (1 + 2 ** (-distance / half_efficiency)) / 2
        own = np.moveaxis(found[5 + number], 1 + number, -2)
        for worth in (0, 1):
            seen_good = (right if worth == 0 else 1 - right).reshape(-1, *[1] * (len(cells) - 1))
            own[..., worth, 0], own[..., worth, 1] = seen_good, 1 - seen_good
    return found


def _drawn(n: int, k: int, seed: int) -> list[Cell]:
    """Different cells."""
    drawn = np.random.default_rng(seed).choice(n * n, k, replace=False)
    return [(int(cell) % n, int(cell) // n) for cell in drawn]
