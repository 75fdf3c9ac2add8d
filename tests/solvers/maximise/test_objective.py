"""The objective that is kept up to date equals the functions evaluated anew, whatever is chosen and changed."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from factored_pomdp.factors import DenseFactor, ExpectedNoisyOr
from factored_pomdp.factors.expected_noisy_or import WeightedCause
from factored_pomdp.variables import Variable
from solvers.maximise.objective import Objective
from tests.strategies import random_module_as_found


def by_loops(cover: ExpectedNoisyOr, choice: dict[str, int]) -> float:
    """Causes that nobody has chosen for are silent; the first that acts pays."""
    total = 0.0
    for cell, weight in enumerate(cover.weights):
        silent, paid = 1.0, 0.0
        for cause in cover.causes:
            if cause.variable is not None and cause.variable.name not in choice:
                continue
            acts = cause.activation[choice[cause.variable.name] if cause.variable is not None else 0, cell]
            paid += silent * acts * cause.payoff[cell]
            silent *= 1 - acts
        total += weight * (paid + silent * cover.off_payoff[cell])
    return total


@pytest.mark.property
@settings(max_examples=80)
@given(st.integers(0, 2**32 - 1), st.booleans())
def test_gains_are_differences_of_plain_evaluations(seed: int, pays_alike: bool) -> None:
    """Several causes on one variable, causes that are decided, certain and impossible detections among them."""
    rng = np.random.default_rng(seed)
    actions = [Variable(f"c{k}", range(3)) for k in range(3)]
    behind = [*actions, actions[0], None]

    def activation(rows: int) -> np.ndarray:
        return rng.choice([0.0, 0.0, 1.0, rng.random()], size=(rows, 7))

    with random_module_as_found():
        payoff = rng.random(7) + 1
        payoffs = [payoff if pays_alike else rng.normal(size=7) for _ in behind]
        causes = [
            WeightedCause(v, activation(3 if v is not None else 1), p) for v, p in zip(behind, payoffs, strict=True)
        ]
        cover = ExpectedNoisyOr(rng.random(7), causes, rng.random(7))
        assert cover.pays_once == pays_alike
        table = DenseFactor([actions[1]], rng.random(3))
        objective = Objective([cover, table])

        def plain(choice: dict[str, int]) -> float:
            return by_loops(cover, choice) + float(table.array[choice["c1"]] if "c1" in choice else table.array.min())

        for _ in range(12):
            variable = actions[rng.integers(3)]
            without = {name: index for name, index in objective.choice.items() if name != variable.name}
            now = plain(objective.choice)
            expected = [plain({**without, variable.name: index}) - now for index in range(3)]
            np.testing.assert_allclose(objective.gains(variable), expected, atol=1e-12)
            objective.choose(variable, int(rng.integers(3)))
            assert objective.value() == pytest.approx(plain(objective.choice), abs=1e-12)
