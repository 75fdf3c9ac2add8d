"""The bounds: full information against sums by hand, clairvoyance against every path of joint presets."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.control.bounds import ClairvoyantController, FullInformationController, best_path
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.loop import run_loop
from surveillance_domain.control.percent_obs import percent_obs
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import motion_parameters, surveillance_model
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.truth_grid import GridTruth
from tests.hand_made import altered, hand_made


@st.composite
def instances(draw) -> tuple[np.ndarray, list[np.ndarray]]:
    """Worth of every joint preset at each of a few steps, and what each camera reaches; small whole numbers tie."""
    sizes = draw(st.lists(st.integers(1, 3), min_size=1, max_size=2))
    steps, joint = draw(st.integers(1, 4)), int(np.prod(sizes))
    worth = draw(st.lists(st.lists(st.integers(0, 4), min_size=joint, max_size=joint), min_size=steps, max_size=steps))
    reach = []
    for size in sizes:
        links = draw(st.lists(st.booleans(), min_size=size * size, max_size=size * size))
        reach.append(np.array(links, dtype=bool).reshape(size, size) | np.eye(size, dtype=bool))
    return np.array(worth, dtype=float), reach


@pytest.mark.property
@settings(max_examples=150)
@given(instances())
def test_no_path_of_joint_presets_is_better(instance):
    worth, reach = instance
    joint = list(product(*(range(len(one)) for one in reach)))

    def reaches(now: tuple[int, ...], then: tuple[int, ...]) -> bool:
        return all(one[a, b] for one, a, b in zip(reach, now, then, strict=True))

    def total(path: tuple[int, ...]) -> float | None:
        places = [(0,) * len(reach), *(joint[number] for number in path)]
        if not all(reaches(now, then) for now, then in pairwise(places)):
            return None
        return float(sum(worth[step, number] for step, number in enumerate(path)))

    best = max(t for path in product(range(len(joint)), repeat=len(worth)) if (t := total(path)) is not None)
    assert total(tuple(best_path(worth, reach))) == best


@pytest.mark.example
def test_looking_ahead_pays_under_slew():
    """Greedy stays at preset 0 for 1 now; to be at preset 2 in time for 5, the first step must be given up."""
    worth = np.array([[1.0, 0, 0], [1, 0, 5], [1, 0, 5]])
    near = np.array([[True, True, False], [True, True, True], [False, True, True]])
    assert best_path(worth, [near]) == [1, 2, 2]
    assert best_path(worth, [np.ones((3, 3), dtype=bool)]) == [0, 2, 2]


@pytest.mark.example
def test_ties_keep_the_present_presets_then_take_the_first():
    free = [np.ones((2, 2), dtype=bool)] * 2
    # joint presets: 00 01 10 11
    worth = np.array([[0, 0, 0, 1.0], [1, 1, 1, 1], [1, 0, 1, 0], [0, 0, 0, 0], [0, 0.5, 0.5, 0]])
    assert best_path(worth, free) == [3, 3, 2, 2, 2]
    assert best_path(np.array([[0, 1.0, 1.0, 0]]), free) == [1]


@pytest.mark.example
def test_the_clairvoyant_counts_targets_in_view_along_their_tracks():
    built = hand_made(["......"], {"a": {"1": [0, 1], "2": [2, 3], "3": [4, 5]}}, 2, pan_deg_per_s=10.0)
    cells = np.array([[0, 3], [0, 5], [5, 5], [5, 4]])
    controller = ClairvoyantController(built, cells)
    found = []
    for _ in cells:
        found.append(controller.choose().presets["a"])
        controller.see(Sighting({}, {}, 0.0))
    # 1 + 1 + 2 + 2; by way of "1" it is 1 + 0 + 2 + 2.
    assert found == ["2", "3", "3", "3"]


@pytest.mark.example
@pytest.mark.parametrize(("pan_deg_per_s", "truth"), [(None, "continuous"), (30.0, "grid")])
def test_nobody_passes_the_clairvoyant_in_any_run(pan_deg_per_s, truth):
    """Perfect eyes and working cameras: the bound holds run by run, on the grid and in metres."""
    built = surveillance_model(altered("tiny", cameras={"*": {"pan_deg_per_s": pan_deg_per_s}}), 3)
    shares = {}
    for name in ("clairvoyant", "full-information", "pomdp", "mp", "msp", "sys", "stat"):
        world = simulated_world(built, truth, 2, 0)
        shares[name] = percent_obs(run_loop(world, make_controller(name, built, Setting(world, 20)), 20))
    assert max(shares.values()) == shares["clairvoyant"]
    assert shares["clairvoyant"] > shares["sys"]


@pytest.mark.example
def test_full_information_chooses_by_true_cells_directions_and_speeds():
    """A target in cell 2 of a row: which way it looks, and how fast it is, decides where to look next."""
    built = hand_made(
        ["....."],
        {"a": {"1": [0], "2": [1], "3": [2], "4": [3], "5": [4]}},
        directions=2,
        speeds_mps=(0.0, 1.0, 2.0),
        sigma_direction_deg=30.0,
        walls="stay",
    )
    start = GridTruth.initial(built.site.grid, motion_parameters(built.site), 1, np.random.default_rng(0))
    for direction, speed, preset in ((0, 0, "3"), (0, 1, "4"), (1, 1, "2"), (0, 2, "5"), (1, 2, "1")):
        truth = replace(start, cells=np.array([2]), directions=np.array([direction]), speeds=np.array([speed]))
        choice = FullInformationController(built, lambda truth=truth: truth).choose()
        assert choice.presets == {"a": preset}
        # 180 degrees of turn at a standard deviation of 30 are 3 sigmas to the bin's border: 0.9973 straight on.
        assert choice.value == pytest.approx(1.0 if speed == 0 else 0.9973, abs=1e-4)


@pytest.mark.example
def test_full_information_keeps_to_what_it_reaches_and_does_not_count_on_cameras_that_are_away():
    views = {"a": {"1": [0], "2": [1], "3": [2]}, "b": {"1": [0], "2": [1], "3": [2]}}
    built = hand_made(["..."], views, pan_deg_per_s=10.0, directions=1, speeds_mps=(0.0,))
    start = GridTruth.initial(built.site.grid, motion_parameters(built.site), 1, np.random.default_rng(0))
    controller = FullInformationController(built, lambda: replace(start, cells=np.array([2])))
    assert controller.choose().value == 0
    controller.see(Sighting({"target1": None}, {"a": None, "b": "2"}, 1.0))
    choice = controller.choose()
    assert choice.presets == {"a": "1", "b": "3"}
    assert choice.value == 1


@pytest.mark.example
def test_too_many_joint_presets_are_refused_with_their_number():
    """11 cameras of three presets: 177,147 joint presets."""
    views = {f"c{number}": {"1": [0], "2": [1], "3": [2]} for number in range(11)}
    built = hand_made(["..."], views)
    world = simulated_world(built, "grid", 0, 0)
    with pytest.raises(ValueError, match=r"full-information .* 177,147 at site drawn are more than 100,000"):
        make_controller("full-information", built, Setting(world, 3))
    with pytest.raises(ValueError, match=r"clairvoyant .* 177,147 at site drawn are more than 20,000"):
        make_controller("clairvoyant", built, Setting(world, 3))
