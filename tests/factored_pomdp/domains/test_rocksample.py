"""RockSample: its rules by hand, its published value, and that it falls into rocks."""

from __future__ import annotations

import math

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.verification import verify
from solvers.myopic import DecomposedMyopic
from solvers.point_based import PointBased
from solvers.solution import Limits


@pytest.mark.example
def test_the_published_map_of_four_by_four() -> None:
    model = fp.domain("rocksample", n=4, k=4)
    assert (model.joint_states, model.joint_actions, model.joint_observations) == (17 * 16, 9, 3)
    # Rock 1 lies at (3, 1): from (0, 2) it is √10 away, from (3, 1) not at all.
    rocks = {f"rock{number}.next": "bad" for number in (2, 3, 4)} | {"rock1.next": "good"}
    far = {"place.next": (0, 2), "act": "check rock1", **rocks}
    factor = model.observation["reading"]
    assert factor.value({**far, "reading": "good"}) == pytest.approx((1 + math.exp(-math.sqrt(10))) / 2)
    assert factor.value({**far, "place.next": (3, 1), "reading": "good"}) == pytest.approx(1.0)
    assert factor.value({**far, "act": "check rock2", "place.next": (2, 1), "reading": "bad"}) == pytest.approx(1.0)
    assert factor.value({**far, "act": "north", "reading": "nothing"}) == 1.0


@pytest.mark.example
def test_the_published_sensor_of_seven_by_eight_halves_in_twenty_cells() -> None:
    model = fp.domain("rocksample", n=7, k=8)
    at = {f"rock{number}.next": "bad" for number in range(1, 9)}
    # Rock 8 at (1, 6), seen from (1, 0): six cells.
    given = {**at, "place.next": (1, 0), "act": "check rock8", "reading": "bad"}
    assert model.observation["reading"].value(given) == pytest.approx((1 + 2 ** (-6 / 20)) / 2)


@pytest.mark.example
def test_moves_rewards_and_the_end() -> None:
    model = fp.domain("rocksample", n=4, k=4)
    world, rng = fp.Simulation(model), np.random.default_rng(0)
    state = {"place": (3, 1), "rock1": "good", "rock2": "good", "rock3": "good", "rock4": "good"}
    after, seen, reward = world.step(state, "sample", rng)
    assert (after["rock1"], after["rock2"], seen["reading"], reward) == ("bad", "good", "nothing", 10.0)
    assert world.step(after, "sample", rng)[2] == -10.0
    after, _, reward = world.step(state, "east", rng)
    assert (after["place"], reward, model.is_terminal(after)) == ("outside", 10.0, True)
    assert world.step(state, "north", rng)[0]["place"] == (3, 2)


@pytest.mark.example
def test_what_is_legal() -> None:
    model = fp.domain("rocksample", n=4, k=4)

    def legal(place: tuple[int, int]) -> set[str]:
        return {act for act in model.actions[0].values if model.is_legal({"act": act}, {"place": place})}

    checks = {f"check rock{number}" for number in range(1, 5)}
    assert legal((0, 0)) == {"north", "east", *checks}
    assert legal((3, 1)) == {"north", "east", "south", "west", "sample", *checks}
    solver = DecomposedMyopic(fp.domain("rocksample", n=2, k=1, seed=0))
    assert {action["act"] for action, _ in solver.values(solver.start())} <= {"east", "south", "sample", "check rock1"}


@pytest.mark.example
def test_a_perfect_look_at_one_rock_on_the_way() -> None:
    """East onto the rock at (1, 1), look, sample it if it is good, leave: 0.95² · (½ (10 + 0.95 · 10) + ½ · 10)."""
    model = fp.domain("rocksample", n=2, k=1, seed=0, half_efficiency=1e9)
    assert model.is_legal({"act": "sample"}, {"place": (1, 1)})
    found = PointBased(model).solve(Limits(precision=1e-6))
    assert found.lower == pytest.approx(13.311875, abs=1e-5)
    assert found.upper == pytest.approx(13.311875, abs=1e-5)


@pytest.mark.example
def test_the_published_value_of_four_by_four() -> None:
    """18.0 in the literature (Smith and Simmons 2005, table 1), to one decimal."""
    found = PointBased(fp.domain("rocksample")).solve(Limits(precision=1e-3))
    assert found.gap <= 1e-3
    assert found.lower == pytest.approx(17.92, abs=0.01)


@pytest.mark.example
@pytest.mark.parametrize(("n", "k"), [(4, 4), (7, 8)])
def test_it_falls_into_rocks_once_the_place_is_known(n: int, k: int) -> None:
    certificate = fp.decompose(fp.domain("rocksample", n=n, k=k))
    assert certificate.known == ("place",)
    assert certificate.blocks == tuple((f"rock{number}",) for number in range(1, k + 1))
    assert not certificate.ties


@pytest.mark.property
def test_joint_and_decomposed_agree() -> None:
    found = verify(fp.domain("rocksample", n=2, k=2), 5, 5, np.random.default_rng(1))
    assert found.holds


@pytest.mark.example
def test_wrong_options_are_all_named() -> None:
    with pytest.raises(ValueError, match=r"n=1: expected 2 to 100; k=0: expected 1 to 11 rocks; half_efficiency=-1"):
        fp.domain("rocksample", n=1, k=0, half_efficiency=-1)
    with pytest.raises(ValueError, match="k=5: expected 1 to 4 rocks"):
        fp.domain("rocksample", n=2, k=5)
