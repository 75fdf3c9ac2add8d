"""Every published model with a known value: our bounds overlap it, and so does what our policy earns."""

from __future__ import annotations

from pathlib import Path

import pytest

import factored_pomdp as fp
from factored_pomdp.episodes import Returns, episodes, steps_that_matter
from solvers import Limits, PointBased

FOLDER = Path(__file__).parents[2] / ".." / "shared" / "data" / "pomdp"
RUNS = 1000

# Lower and upper bounds of the optimal value at the start, from the folder's README.
QUICK = {
    "cassandra/1d.POMDP": (1.26034, 1.2604),
    "cassandra/4x3.95.POMDP": (1.88988, 1.88998),
    "cassandra/Tiger.pomdp": (19.3713, 19.3714),
    "cassandra/cheese.95.POMDP": (3.48612, 3.48621),
    "cassandra/mini-hall2.pomdp": (2.71427, 2.71437),
    "cassandra/paint.95.pomdp": (3.2936, 3.29368),
    "cassandra/parr95.95.POMDP": (7.20094, 7.20104),
    "cassandra/shuttle.95.POMDP": (32.8896, 32.8897),
    "cassandra/tiger.95.POMDP": (19.3713, 19.3714),
    "cassandra/tiger.aaai.POMDP": (1.93339, 1.93349),
    "cassandra/uav-search.raissa-bravo.orig.POMDP": (4.29638, 4.29647),
    "pomdpx/Tiger.pomdpx": (19.3713, 19.3714),
    "pomdpx/functional_imitation.pomdpx": (183.717, 183.717),
    "pomdpx/rockSample-3_1.pomdpx": (12.8719, 12.8719),
}
LONG = {
    "cassandra/Hallway.pomdp": (1.0009, 1.2041),
    "cassandra/learning.c2.pomdp": (1.48788, 1.58239),
    "cassandra/network.pomdp": (293.185, 293.315),
    "cassandra/query.s2.pomdp": (490.741, 496.529),
}


def _load(name: str) -> fp.FactoredPOMDP:
    if not (FOLDER / name).is_file():
        pytest.skip(f"{name} is not here")
    return fp.load(FOLDER / name)


@pytest.mark.example
@pytest.mark.parametrize("name", QUICK)
def test_bounds_overlap_the_published_ones(name: str) -> None:
    solution = PointBased(_load(name)).solve(Limits(precision=5e-3, time_limit=10.0))
    lower, upper = QUICK[name]
    rounding = 1e-5 * abs(upper)
    assert solution.lower <= upper + rounding
    assert solution.upper >= lower - rounding


@pytest.mark.example
@pytest.mark.slow
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", [*QUICK, *LONG])
def test_what_the_policy_earns_lies_between_our_bounds(name: str) -> None:
    model = _load(name)
    solution = PointBased(model).solve(Limits(precision=1e-3, time_limit=20.0))
    lower, upper = {**QUICK, **LONG}[name]
    assert solution.lower <= upper + 1e-5 * abs(upper)
    assert solution.upper >= lower - 1e-5 * abs(upper)
    steps = steps_that_matter(model)
    returns = Returns(model, steps)
    for total in episodes(model, solution.policy, RUNS, steps, seed=0):
        returns.add(total)
    low, high = returns.interval(0.99)
    assert low - returns.truncation_error <= solution.upper
    assert solution.lower <= high + returns.truncation_error
