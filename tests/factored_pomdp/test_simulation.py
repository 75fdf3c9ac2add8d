"""Simulated frequencies against exact probabilities, and worlds too large to expand."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor, NoisyOr, SparseFactor
from tests.plain import PlainModel
from tests.strategies import random_models

DRAWS = 400


@pytest.mark.property
@settings(max_examples=8)
@given(random_models(most_states=3), st.integers(0, 2**32 - 1))
def test_frequencies_are_the_models_probabilities(model: fp.FactoredPOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    plain, simulation = PlainModel(model), fp.Simulation(model)
    starts = Counter(tuple(simulation.start(rng).values()) for _ in range(DRAWS))
    assert_frequencies(starts, {tuple(s.values()): p for s, p in zip(plain.states, plain.start, strict=True)})
    state = simulation.start(rng)
    action = plain.actions[int(rng.integers(len(plain.actions)))]
    drawn: Counter = Counter()
    for _ in range(DRAWS):
        after, seen, reward = simulation.step(state, action, rng)
        assert reward == pytest.approx(plain.reward(state, action, after, seen))
        drawn[(*after.values(), *seen.values())] += 1
    exact = {
        (*after.values(), *seen.values()): plain.moves(state, action, after) * plain.sees(after, action, seen)
        for after in plain.states
        for seen in plain.observations
    }
    assert_frequencies(drawn, exact)


def assert_frequencies(drawn: Counter, exact: dict[tuple, float]) -> None:
    """Nothing impossible is drawn, and every count lies within six standard deviations of its expectation."""
    total = drawn.total()
    for outcome, probability in exact.items():
        spread = np.sqrt(total * probability * (1 - probability))
        assert abs(drawn[outcome] - total * probability) <= 6 * spread + 1e-9 + (1 if probability > 0 else 0)
    assert set(drawn) <= set(exact)


@pytest.mark.example
def test_equal_seeds_give_equal_worlds() -> None:
    model = fp.domain("machine-repair", machines=2)
    runs = []
    for _ in range(2):
        simulation, rng = fp.Simulation(model), np.random.default_rng(5)
        state, run = simulation.start(rng), []
        for _ in range(20):
            state, seen, reward = simulation.step(state, {"machine1.hand": "run", "machine2.hand": "run"}, rng)
            run.append((state, seen, reward))
        runs.append(run)
    assert runs[0] == runs[1]


@pytest.mark.example
def test_a_noisy_or_of_thirty_causes_and_a_sparse_walk_are_drawn() -> None:
    cells, bits = fp.Variable("cell", range(3000)), [fp.Variable(f"bit{k}", [0, 1]) for k in range(30)]
    steps = np.arange(3000)
    walk = SparseFactor([cells, cells.next], np.stack([steps, (steps + 1) % 3000], axis=1), np.ones(3000))
    never, sure = np.zeros((2, 1)), np.array([[0.0], [1.0]])
    seen = fp.Variable("seen", ["no", "yes"])
    causes = [
        fp.Cause(bit.next, sure if k == 29 else never, sparse.csr_array([[0.0, 1.0]])) for k, bit in enumerate(bits)
    ]
    model = fp.FactoredPOMDP(
        states=[cells, *bits],
        actions=[fp.Variable("act", ["wait"])],
        observations=[seen],
        transition={"cell": walk} | {bit.name: DenseFactor([bit.next], [0.5, 0.5]) for bit in bits},
        observation={"seen": NoisyOr((), seen, "no", causes)},
        reward={"r": lambda cell: float(cell)},
        initial={"cell": 2998} | {bit.name: 0 for bit in bits},
    )
    simulation, rng = fp.Simulation(model), np.random.default_rng(1)
    state = simulation.start(rng)
    walked = []
    for _ in range(3):
        state, observation, _ = simulation.step(state, "wait", rng)
        walked.append(state["cell"])
        assert observation["seen"] == ("yes" if state["bit29"] else "no")
    assert walked == [2999, 0, 1]
