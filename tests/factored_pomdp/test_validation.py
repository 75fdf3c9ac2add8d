"""Every fault of a distribution, with the parents' assignment and the number found; small drifts are mended."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import sparse

from factored_pomdp.errors import Fault
from factored_pomdp.factors import Cause, DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.validation import checked_distribution, checked_reward, is_certain
from factored_pomdp.variables import Variable

A, B = Variable("a", ["x", "y"]), Variable("b", [(0, 0), (0, 1)])


def check(factor: Factor, child: Variable) -> tuple[Factor, list[str], list[str]]:
    faults: list[Fault] = []
    notes: list[str] = []
    checked = checked_distribution(factor, child, f"transition of {child.name}", faults, notes)
    return checked, [str(fault) for fault in faults], notes


@pytest.mark.example
@pytest.mark.parametrize("form", ["dense", "sparse"])
def test_all_faults_of_a_table_at_once(form: str) -> None:
    numbers = [[[0.5, 0.4], [1.2, -0.2]], [[float("nan"), 1.0], [0.25, 0.75]]]
    factor = DenseFactor([A, B, B.next], numbers)
    _, faults, notes = check(factor if form == "dense" else factor.sparse(), B.next)
    assert faults == [
        "transition of b.next at a=x, b=(0, 1), b.next=(0, 0): found 1.2; expected a probability in [0, 1]",
        "transition of b.next at a=x, b=(0, 1), b.next=(0, 1): found -0.2; expected a probability in [0, 1]",
        "transition of b.next at a=y, b=(0, 0), b.next=(0, 0): found nan; expected a probability in [0, 1]",
        "transition of b.next at a=x, b=(0, 0): found probabilities that sum to 0.9; expected sum 1",
    ]
    assert notes == []


@pytest.mark.example
def test_the_assignment_is_right_where_the_child_is_not_the_last_axis() -> None:
    factor = DenseFactor([A, B.next, B], [[[1, 0.5], [0, 0.5]], [[1, 0.3], [0, 0.3]]])
    _, faults, _ = check(factor, B.next)
    assert faults == ["transition of b.next at a=y, b=(0, 1): found probabilities that sum to 0.6; expected sum 1"]


@pytest.mark.example
@pytest.mark.parametrize("form", ["dense", "sparse"])
@pytest.mark.parametrize(
    ("total", "kind"), [(0.999999, "mended"), (1.000009, "mended"), (0.99998, "wrong"), (1.0 - 1e-12, "silent")]
)
def test_a_small_drift_is_renormalised_with_a_note(form: str, total: float, kind: str) -> None:
    factor = DenseFactor([A, B], [[0.5, 0.5], [0.25, total - 0.25]])
    checked, faults, notes = check(factor if form == "dense" else factor.sparse(), B)
    if kind == "wrong":
        assert faults == ["transition of b at a=y: found probabilities that sum to 0.99998; expected sum 1"]
        return
    assert faults == []
    np.testing.assert_allclose(checked.array_over([A, B]).sum(axis=1), 1.0, rtol=0, atol=1e-16)
    assert checked.array_over([A, B])[1, 0] == pytest.approx(0.25 / total, abs=1e-15)
    if kind == "mended":
        assert notes == [f"transition of b: 1 of 2 distributions renormalised (worst sum {total:.9g} at a=y)"]
    else:
        assert notes == []


@pytest.mark.example
def test_positions_outside_and_twice() -> None:
    _, faults, _ = check(SparseFactor([A, B], [[0, 0], [1, 2]], [1.0, 1.0]), B)
    assert faults == ["transition of b, entry at position (1, 2): found no such place; expected below [2, 2]"]
    _, faults, _ = check(SparseFactor([A, B], [[0, 0], [1, 1], [1, 1]], [1.0, 0.5, 0.5]), B)
    assert faults == ["transition of b at a=y, b=(0, 1): found several entries; expected one entry for each assignment"]
    _, faults, _ = check(DeterministicFactor([A], B, [0, 2]), B)
    assert faults == ["transition of b at a=y: found value number 2; expected 0 to 1"]


def noisy(activation: list, emission: list) -> NoisyOr:
    seen = Variable("seen", ["nothing", "x", "y"])
    return NoisyOr([A], seen, "nothing", [Cause(B, np.array(activation), sparse.csr_array(np.array(emission)))])


@pytest.mark.example
def test_all_faults_of_a_noisy_or_at_once() -> None:
    factor = noisy([[0.5, 1.5], [float("nan"), 0]], [[0.1, 0.9, 0.0], [0.0, 0.5, 0.4]])
    _, faults, _ = check(factor, factor.child)
    assert faults == [
        "transition of seen, cause b=(0, 0) at a=y: found 1.5; expected a probability in [0, 1]",
        "transition of seen, cause b=(0, 1) at a=x: found nan; expected a probability in [0, 1]",
        "transition of seen, emission of b at a=y: found probabilities that sum to 0.9; expected sum 1",
        "transition of seen, emission of b: found mass on 'nothing'; expected none: that value means silence",
    ]


@pytest.mark.example
def test_emissions_are_renormalised_too() -> None:
    factor = noisy([[0.5, 1.0], [0.5, 0]], [[0.0, 0.5, 0.499999], [0.0, 1.0, 0.0]])
    checked, faults, notes = check(factor, factor.child)
    assert faults == []
    assert notes == ["transition of seen: 1 of its causes' emissions renormalised"]
    np.testing.assert_allclose(checked.dense().array.sum(axis=-1), 1.0, rtol=0, atol=1e-15)


@pytest.mark.example
def test_rewards_are_finite() -> None:
    faults: list[Fault] = []
    checked_reward(DenseFactor([A], [float("inf"), -1e9]), "reward r", faults)
    checked_reward(SparseFactor([A, B], [[1, 0]], [float("nan")]), "reward s", faults)
    assert [str(fault) for fault in faults] == [
        "reward r at a=x: found inf; expected a finite number",
        "reward s at a=y, b=(0, 0): found nan; expected a finite number",
    ]


@pytest.mark.example
def test_certain_is_what_leaves_no_chance() -> None:
    assert is_certain(DeterministicFactor([A], B, [0, 1]), "b")
    assert is_certain(DenseFactor([A, B], [[1, 0], [0, 1]]), "b")
    assert is_certain(DenseFactor([A, B], [[1, 0], [0, 1]]).sparse(), "b")
    assert not is_certain(DenseFactor([A, B], [[1, 0], [0.5, 0.5]]), "b")
    assert not is_certain(noisy([[1.0, 1.0], [1.0, 1.0]], [[0, 1.0, 0], [0, 0, 1.0]]), "seen")
