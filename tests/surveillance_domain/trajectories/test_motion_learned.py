"""What is learned from moves, and how it is judged: hand-computed numbers, and known numbers found again."""

from __future__ import annotations

import math

import numpy as np
import pytest

from surveillance_domain.model.parameters import MotionParameters
from surveillance_domain.site.grid import Grid
from surveillance_domain.trajectories.fitting import MotionFit, fit_motion, speed_set, wrapped_gaussian_sigma
from surveillance_domain.trajectories.held_out import held_out_log_likelihood, verdict
from surveillance_domain.trajectories.prior import cell_prior
from surveillance_domain.trajectories.tracks import Track
from surveillance_domain.trajectories.transitions import Transitions, split_people, transitions
from surveillance_domain.world.truth_continuous import ContinuousTruth


def track(points: list[tuple[float, float]], name: str = "a") -> Track:
    return Track(name, np.arange(len(points), dtype=float), np.array(points, dtype=float))


def pairs(before: list[tuple[float, float]], after: list[tuple[float, float]]) -> Transitions:
    moves = np.array(before + after, dtype=float)
    people = np.arange(len(before))
    return Transitions(moves[: len(before)], moves[len(before) :], people, 1.0, moves, np.hypot(*moves.T))


@pytest.mark.example
def test_moves_turns_and_changes_of_speed() -> None:
    found = transitions([track([(0, 0), (1, 0), (1, 2), (0.9, 2)])], 1.0)
    assert found.before_m.tolist() == [[1, 0], [0, 2]]
    assert found.moves_mps.tolist() == pytest.approx([1, 2, 0.1])
    assert np.degrees(found.turns_rad).tolist() == pytest.approx([90])  # the last move is too slow to have a direction
    assert found.speed_changes_mps.tolist() == pytest.approx([1, -1.9])


@pytest.mark.example
def test_turns_are_the_short_way_round() -> None:
    angles = np.radians([170.0, -170.0])
    moves = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    found = pairs([tuple(moves[0])], [tuple(moves[1])])
    assert np.degrees(found.turns_rad).tolist() == pytest.approx([20])


@pytest.mark.example
def test_small_turns_have_the_root_mean_square_as_sigma() -> None:
    turns = np.radians([3.0, -4.0, 0.0, 5.0])
    assert math.degrees(wrapped_gaussian_sigma(turns)) == pytest.approx(math.sqrt(50 / 4), rel=1e-5)


@pytest.mark.example
def test_no_turn_at_all_has_no_sigma() -> None:
    assert wrapped_gaussian_sigma(np.zeros(5)) == 0.0


@pytest.mark.property
@pytest.mark.parametrize("sigma_deg", [5.0, 30.0, 90.0])
def test_sigma_of_a_wound_gaussian_is_found(sigma_deg: float) -> None:
    drawn = np.radians(np.random.default_rng(1).normal(0, sigma_deg, 20_000))
    wound = np.pi - (np.pi - drawn) % (2 * np.pi)
    assert math.degrees(wrapped_gaussian_sigma(wound)) == pytest.approx(sigma_deg, rel=0.03)


@pytest.mark.example
def test_speed_sets() -> None:
    speeds = np.array([0.0, 0.02, 0.98, 1.0, 1.02, 1.9, 2.1])
    assert speed_set(speeds, 3) == (0.01, 1.0, 2.0)
    assert speed_set(np.array([1.0, 1.0, 1.0]), 3) == (1.0,)
    assert speed_set(np.array([0.5, 0.0, 0.5]), 4) == (0.0, 0.5)


@pytest.mark.property
def test_the_numbers_of_simulated_people_are_found_again() -> None:
    """People of the continuous truth in a hall so large that they meet no wall."""
    grid = Grid(np.ones((300, 300), dtype=bool), cell_m=10.0)
    parameters = MotionParameters(8, (1.0, 2.0), 20.0, 0.0, "reject", 0.5)
    truth = ContinuousTruth.initial(grid, parameters, 30, np.random.default_rng(3))
    places = [truth.positions_m]
    for _ in range(60):
        truth = truth.step()
        places.append(truth.positions_m)
    times = 0.5 * np.arange(61)
    tracks = [Track(str(k), times, np.array([at[k] for at in places])) for k in range(30)]
    fit = fit_motion(transitions(tracks, 0.5), speeds=2)
    assert fit.sigma_direction_deg == pytest.approx(20, rel=0.05)
    assert fit.sigma_speed_mps == pytest.approx(0, abs=1e-6)
    assert fit.speeds_mps == pytest.approx((1.0, 2.0), abs=1e-3)
    judged = held_out_log_likelihood(fit, transitions(tracks, 0.5), 0.5, 8)
    assert judged.model > judged.constant_velocity > judged.random_walk
    assert judged.over_constant_velocity[0] > 0


@pytest.mark.example
def test_people_who_stand_have_no_direction() -> None:
    with pytest.raises(ValueError, match="nobody walks two steps of 1 s on end"):
        fit_motion(transitions([track([(0, 0), (0.1, 0), (0, 0)])], 1.0))


@pytest.mark.example
def test_the_held_out_are_other_people() -> None:
    tracks = [track([(0, 0), (1, 0)], name) for name in "aabbccddee"]
    training, rest = split_people(tracks, 0.4, np.random.default_rng(0))
    assert (len(training), len(rest)) == (6, 4)
    assert not {one.name for one in training} & {one.name for one in rest}


def fitted(**changes: float) -> MotionFit:
    numbers = {"sigma_direction_deg": 0.0, "sigma_speed_mps": 0.0, "random_walk_m": 1.0, "constant_velocity_m": 0.0}
    return MotionFit(speeds_mps=(1.0,), mean_speed_mps=1.0, step_s=1.0, **(numbers | changes))


@pytest.mark.example
def test_straight_on_is_foretold_but_for_the_background() -> None:
    """A whole cell straight on: probability 0.999 + 0.001/25 (a window of 5 x 5); a random walk of 1 cell: (E tri)²."""
    judged = held_out_log_likelihood(fitted(), pairs([(1, 0)], [(1, 0)]), 1.0, 4)
    best = math.log(0.999 + 0.001 / 25)
    assert judged.model == pytest.approx(best, abs=1e-12)
    assert judged.on_grid == pytest.approx(best, abs=1e-12)
    assert judged.constant_velocity == pytest.approx(best, abs=1e-12)
    xs = np.linspace(-9, 9, 200_001)
    density = np.exp(-(xs**2) / 2) / math.sqrt(2 * math.pi)
    along, aside = (float(np.trapezoid(density * np.maximum(1 - abs(xs - k), 0), xs)) for k in (1, 0))
    assert judged.random_walk == pytest.approx(math.log(0.999 * along * aside + 0.001 / 25), abs=1e-6)
    assert judged.impossible == 0


@pytest.mark.example
def test_a_turn_that_the_model_forbids_is_impossible_on_the_grid() -> None:
    judged = held_out_log_likelihood(fitted(), pairs([(1, 0), (1, 0)], [(1, 0), (0, 1)]), 1.0, 4)
    assert judged.impossible == 0.5
    assert judged.on_grid == pytest.approx((math.log(0.999 + 0.001 / 25) + math.log(0.001 / 25)) / 2)


@pytest.mark.example
def test_displacements_between_cells_are_shared_by_area() -> None:
    """1.5 cells at 1.5 cells a step: half on each of two cells, foretold as one half each."""
    judged = held_out_log_likelihood(
        MotionFit(0.0, 0.0, (1.5,), 1.5, 1.0, 1.0, 0.0), pairs([(1.5, 0)], [(1.5, 0)]), 1.0, 8
    )
    window = (2 * 3 + 1) ** 2
    assert judged.on_grid == pytest.approx(math.log(0.999 * 0.5 + 0.001 / window))


@pytest.mark.example
def test_a_fit_of_another_step_is_refused() -> None:
    with pytest.raises(ValueError, match=r"steps of 1 s cannot be judged by steps of 2 s"):
        held_out_log_likelihood(fitted(), transitions([track([(0, 0), (1, 0)] * 4)], 2.0), 1.0, 4)


@pytest.mark.example
def test_the_prior_counts_visits() -> None:
    prior = cell_prior(np.array([[-0.5, 0.5], [-0.4, 0.5], [1.5, 1.5]]), 1.0, smoothing=0.5)
    assert prior.origin_m == (-1.0, 0.0)
    assert (prior.probability * 6).tolist() == [[2.5, 0.5, 0.5], [0.5, 0.5, 1.5]]


@pytest.mark.example
def test_one_speed_is_the_mean_and_twenty_are_no_more_than_there_are() -> None:
    speeds = np.array([0.5, 1.0, 1.5, 1.6])
    assert speed_set(speeds, 1) == (1.15,)
    assert speed_set(speeds, 4) == speed_set(speeds, 20) == (0.5, 1.0, 1.5, 1.6)
    many = np.random.default_rng(0).gamma(9.0, 0.15, 500)
    assert len(speed_set(many, 20)) == 20
    assert speed_set(np.full(9, 1.2), 1) == (1.2,)


@pytest.mark.example
@pytest.mark.parametrize(
    ("gain", "told"), [((0.1, 0.2), "better"), ((-0.2, -0.1), "worse"), ((-0.1, 0.2), "undecided")]
)
def test_an_interval_that_holds_zero_decides_nothing(gain: tuple[float, float], told: str) -> None:
    assert verdict(gain) == told


@pytest.mark.example
def test_cells_too_small_to_be_judged_on_are_refused_with_the_size() -> None:
    moves = pairs([(1.0, 0.0)] * 3, [(1.0, 0.0)] * 3)
    fit = fit_motion(moves, 1)
    # a move of 1 m goes over 1,000 cells: a window of 2 * 1,001 + 1 cells a side, 8 directions and standing
    with pytest.raises(ValueError, match=r"9 x 1 x 2,003 x 2,003 = 3.61e\+07 numbers \(0.3 GB\).*of about 0.0015 or"):
        held_out_log_likelihood(fit, moves, 0.001, 8)


@pytest.mark.property
def test_who_is_held_out_does_not_depend_on_the_order() -> None:
    rng = np.random.default_rng(1)
    tracks = [track([(float(n), 0.0), (n + 1.0, 0.5)], f"p{n}") for n in range(9)]
    for seed in range(5):
        _, held = split_people(tracks, 0.4, np.random.default_rng(seed))
        mixed = [tracks[number] for number in rng.permutation(len(tracks))]
        for other in (tracks[::-1], mixed):
            _, again = split_people(other, 0.4, np.random.default_rng(seed))
            assert {one.name for one in again} == {one.name for one in held}
