"""Point-based search: known values, bounds that hold on random models, what its policy earns."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given, settings

import factored_pomdp as fp
from factored_pomdp.simulation import Simulation
from solvers import Exact, Limits, PointBased
from solvers.alpha_vectors import VectorSet
from solvers.flat import FlatModel, flatten
from solvers.point_based_kernels import add_vector
from solvers.search_state import Search, new_search
from solvers.solution import Progress
from tests.solvers.small_models import small_models


@pytest.mark.example
def test_tiger() -> None:
    solution = PointBased(fp.domain("tiger")).solve(Limits(precision=1e-6))
    assert solution.lower == pytest.approx(19.371368, abs=1e-5)
    assert solution.upper == pytest.approx(19.371368, abs=1e-5)
    assert solution.lower <= solution.upper
    assert solution.stopped == "precision"


@pytest.mark.property
@settings(max_examples=40)
@given(small_models(discount=0.6))
def test_bounds_hold_and_close(model: fp.FactoredPOMDP) -> None:
    """Against 6 exact steps: the rest is worth at most γ⁶ max|R| / (1 − γ)."""
    found = PointBased(model).solve(Limits(precision=1e-4, time_limit=20.0))
    solution = Exact(model).solve(Limits(horizon=6))
    rest = 0.6**6 * np.abs(fp.joint(model).reward).max() / 0.4
    assert found.upper - found.lower <= 1e-4 + 1e-9
    assert solution.lower - rest <= found.upper + 1e-9
    assert found.lower - 1e-9 <= solution.lower + rest


@pytest.mark.property
@settings(max_examples=20)
@given(small_models(discount=0.6))
def test_both_bounds_are_backed_up_by_what_they_say_one_step_ahead(model: fp.FactoredPOMDP) -> None:
    """At any belief: lower ≤ one step of its own action and lower bounds after; upper ≥ the best such step."""
    policy = PointBased(model).solve(Limits(precision=0.05, time_limit=20.0)).policy
    flat, rng = policy.flat, np.random.default_rng(0)
    first, past = flat.tables.class_start[flat.class_at(flat.initial) :][:2]
    for _ in range(5):
        belief = np.zeros(flat.size)
        belief[first:past] = rng.dirichlet(np.ones(past - first))
        decision = policy.decide(belief[flat.rank])
        ahead = [_one_step(policy, belief, action) for action in range(len(flat.actions))]
        chosen = flat.actions.index(dict(decision.action))
        assert decision.value <= ahead[chosen][0] + 1e-9
        assert decision.value <= decision.upper_bound


def _one_step(policy: object, belief: np.ndarray, action: int) -> tuple[float, float]:
    flat = policy.flat
    moved = belief @ flat.transition[action]
    totals = np.array([flat.reward[action] @ belief] * 2)
    for column in flat.observation[action].toarray().T:
        after = moved * column
        if after.sum() > 0:
            totals += flat.discount * after.sum() * np.array(policy.bounds(after / after.sum()))
    return float(totals[0]), float(totals[1])


@pytest.mark.example
def test_simulated_return_lies_between_the_bounds() -> None:
    model = fp.domain("tiger", discount=0.5)
    solution = PointBased(model).solve(Limits(precision=1e-4))
    simulation, rng, returns = Simulation(model), np.random.default_rng(3), []
    for _ in range(250):
        state, belief, total = simulation.start(rng), solution.policy.start(), 0.0
        for step in range(9):
            action = solution.policy.decide(belief).action
            state, seen, reward = simulation.step(state, action, rng)
            belief = belief.predict(action).condition(seen)
            total += 0.5**step * reward
        returns.append(total)
    error = 2.576 * np.std(returns) / np.sqrt(250) + 0.5**9 * 100 / 0.5
    assert solution.lower - error <= np.mean(returns) <= solution.upper + error


@pytest.mark.example
def test_progress_is_told_and_never_worsens() -> None:
    told: list[Progress] = []
    PointBased(fp.domain("machine-repair")).solve(Limits(precision=1e-9, time_limit=1.5, progress=told.append))
    assert len(told) > 1
    assert all(one.lower <= two.lower + 1e-12 for one, two in itertools.pairwise(told))
    assert all(one.upper >= two.upper - 1e-12 for one, two in itertools.pairwise(told))
    assert told[-1].gap < told[0].gap


@pytest.mark.example
def test_interrupted_it_gives_the_best_so_far() -> None:
    def stop(progress: Progress) -> None:
        raise KeyboardInterrupt

    solution = PointBased(fp.domain("machine-repair")).solve(Limits(precision=1e-9, progress=stop))
    assert solution.stopped == "interrupted"
    assert solution.lower < solution.upper


@pytest.mark.example
def test_refuses_a_discount_of_one_and_a_horizon() -> None:
    ability = PointBased.can_solve(fp.domain("tiger", discount=1.0))
    assert not ability
    assert "discount 1" in ability.because
    with pytest.raises(ValueError, match="discount 1"):
        PointBased(fp.domain("tiger", discount=1.0))
    with pytest.raises(ValueError, match="take exact"):
        PointBased(fp.domain("tiger")).solve(Limits(horizon=3))


@pytest.mark.example
def test_dominated_vectors_go() -> None:
    flat = flatten(fp.domain("tiger"))
    search = _searched(flat, [[0.0, 0.0]])
    for action, vector in ((1, [1.0, -1.0]), (1, [0.5, -2.0]), (2, [2.0, 0.0])):
        place = search.used[0].numbers
        search.numbers[place : place + 2] = vector
        add_vector.py_func(search, search.kinds[0], action, 2)
    assert search.used[0].vectors == 3  # the third was below the second
    assert search.kinds[0].vector == 2
    assert search.vectors[2].next == -1
    assert search.numbers[search.vectors[2].start :][:2].tolist() == [2.0, 0.0]
    assert (search.kinds[0].default, search.kinds[0].default_worth) == (2, 2.0)


def _searched(flat: FlatModel, vectors: list[list[float]]) -> Search:
    """A search with first vectors, whose records are read as compiled loops read them."""
    first = VectorSet.everywhere(flat, np.array(vectors), np.zeros((len(vectors), flat.size), int))
    search = new_search(flat, np.zeros((len(flat.actions), flat.size)), first)
    return Search(*(array.view(np.recarray) for array in search))
