"""The verification on models where it must find nothing, and on mistakes that it must find."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp import registry, verification
from factored_pomdp.beliefs.comparison import Comparison, joint_of, random_product_belief, sampled_state, spelled_out
from factored_pomdp.factors import DenseFactor
from factored_pomdp.verification import TOLERANCE, Verification, verifications, verify
from solvers import DecomposedMyopic, JointMyopic
from tests.plain import PlainModel
from tests.strategies import independent_models, random_models


@pytest.mark.property
@settings(max_examples=20)
@given(random_models(most_states=3), st.integers(0, 2**32 - 1), st.booleans())
def test_no_difference_on_random_models(model: fp.FactoredPOMDP, seed: int, sparse: bool) -> None:
    found = verify(model, 1, 2, np.random.default_rng(seed), sparse=sparse)
    assert found.holds, found.first_difference
    assert (found.beliefs, found.steps, found.actions_agree) == (1, 2, 1.0)
    assert max(found.max_value_difference, found.max_belief_difference) <= TOLERANCE


@pytest.mark.property
@settings(max_examples=12)
@given(independent_models(), st.integers(0, 2**32 - 1))
def test_no_difference_on_models_that_fall_apart(model: fp.FactoredPOMDP, seed: int) -> None:
    assert verify(model, 1, 2, np.random.default_rng(seed)).holds


@pytest.mark.property
@settings(max_examples=15)
@given(random_models(most_states=3), st.integers(0, 2**32 - 1))
def test_joint_solver_dense_and_sparse_give_the_values_of_plain_loops(model: fp.FactoredPOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    plain = PlainModel(model)
    product = random_product_belief(model, fp.Simulation(model).start(rng), rng)
    dense, sparse = joint_of(product), joint_of(product, sparse=True)
    belief = np.broadcast_to(dense.table.array_over(model.states), [v.size for v in model.states]).ravel().tolist()
    valued = JointMyopic(model).values(dense)
    assert [action for action, _ in valued] == [action for action, _ in JointMyopic(model, sparse=True).values(sparse)]
    for (action, ours), (_, other) in zip(valued, JointMyopic(model, sparse=True).values(sparse), strict=True):
        exact = plain.value(belief, action)
        assert ours == pytest.approx(exact, abs=1e-11)
        assert other == pytest.approx(exact, abs=1e-11)


@pytest.mark.example
@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("tiger", {}),
        ("machine-repair", {"machines": 2}),
        ("machine-repair", {"machines": 2, "coupled": True}),
        ("surveillance", {"site": "micro", "targets": 2}),
        ("surveillance", {"site": "micro", "targets": 2, "detection_probability": 0.8, "cell_noise_m": 0.5}),
    ],
)
def test_no_difference_on_installed_domains(name: str, options: dict[str, Any]) -> None:
    found = verify(fp.domain(name, **options), 2, 2, np.random.default_rng(3))
    assert found.holds, found.first_difference


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("options", [{}, {"detection_probability": 0.8, "cell_noise_m": 0.7}])
@pytest.mark.parametrize(("site", "targets"), [("tiny", 2), ("tiny-3", 3)])
def test_no_difference_on_small_sites(site: str, targets: int, options: dict[str, float]) -> None:
    model = fp.domain("surveillance", site=site, targets=targets, **options)
    found = verify(model, 10, 20, np.random.default_rng(3))
    assert found.holds, found.first_difference


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.timeout(1800)
def test_no_difference_on_lego_through_the_sparse_oracle() -> None:
    model = fp.domain("surveillance", site="lego", targets=2, detection_probability=1.0, cell_noise_m=0.0)
    with pytest.raises(fp.TooLarge, match="11,059,200 joint states"):
        verify(model, 1, 0, np.random.default_rng(3))
    found = verify(model, 2, 1, np.random.default_rng(3), sparse=True)
    assert found.holds, found.first_difference


class Mistaken(DecomposedMyopic):
    """Forgets a hundredth of the value of looking after the first machine."""

    def local_functions(self, belief: fp.ProductBelief) -> list[fp.Factor]:
        action = self.model.actions[0]
        return [*super().local_functions(belief), DenseFactor([action], 0.01 * np.arange(action.size))]


def use_instead(monkeypatch: pytest.MonkeyPatch, solver: type) -> None:
    original = registry.solver
    monkeypatch.setattr(registry, "solver", lambda name: solver if name == "myopic" else original(name))


@pytest.mark.example
def test_a_wrong_value_is_found_and_written_out_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    use_instead(monkeypatch, Mistaken)
    found = verify(fp.domain("machine-repair", machines=2), 2, 0, np.random.default_rng(0))
    assert not found.holds
    assert found.max_value_difference == pytest.approx(0.01)
    first = found.first_difference
    assert first is not None
    assert (first.what, first.where) == ("value", "random belief 1")
    assert first.decomposed - first.joint == pytest.approx(0.01)
    assert first.action["machine1.hand"] == "repair"
    assert sum(first.belief["machine2"].values()) == pytest.approx(1.0)


class Contrary(DecomposedMyopic):
    """Values right, chooses the worst."""

    def decide(self, belief: fp.ProductBelief, prefer: Mapping[str, Any] | None = None) -> Any:
        best = super().decide(belief, prefer)
        actions = [{v.name: value for v in self.model.actions} for value in ("run", "repair")]
        worst = min(actions, key=lambda action: self.value(belief, action))
        return replace(best, action=worst, value=self.value(belief, worst))


@pytest.mark.example
def test_a_worse_action_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    use_instead(monkeypatch, Contrary)
    found = verify(fp.domain("machine-repair", machines=2), 4, 0, np.random.default_rng(0))
    assert found.actions_agree == 0.0
    assert found.max_value_difference <= TOLERANCE
    assert found.first_difference is not None
    assert found.first_difference.what == "action"
    assert found.first_difference.joint > found.first_difference.decomposed


@pytest.mark.example
def test_a_tie_that_is_ignored_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    kept_apart = fp.initial_belief
    monkeypatch.setattr(verification, "initial_belief", lambda model: kept_apart(model, project=True))
    found = verify(fp.domain("machine-repair", machines=2, coupled=True), 0, 15, np.random.default_rng(2))
    assert found.first_difference is not None
    assert found.first_difference.what == "belief"
    assert set(found.first_difference.observation or {}) == {f"machine{n}.part" for n in (1, 2)}
    assert found.max_belief_difference > 1e-3


@pytest.mark.example
def test_comparison_sees_mass_outside_and_wrong_marginals() -> None:
    model = fp.domain("machine-repair", machines=2)
    start = fp.initial_belief(model)
    first = start.with_arrays([np.array([[0.5, 1.0], [0.5, 0.0], [0.0, 0.0]])])
    second = start.with_arrays([np.array([[1.0, 1.0], [0.0, 0.0], [0.0, 0.0]])])
    gap = Comparison.of(joint_of(second), first)
    assert gap.outside.product == pytest.approx(0.5)
    assert gap.states.product == pytest.approx(0.5)
    assert gap.states.at == "machine1=good, machine2=good"
    assert abs(gap.blocks[0].joint - gap.blocks[0].product) == pytest.approx(0.5)
    same = Comparison.of(joint_of(first), first).worst()
    assert same.joint == pytest.approx(same.product, abs=1e-15)


@pytest.mark.property
@settings(max_examples=15)
@given(random_models(), st.integers(0, 2**32 - 1))
def test_sampled_states_have_mass_and_beliefs_are_spelled_out(model: fp.FactoredPOMDP, seed: int) -> None:
    rng = np.random.default_rng(seed)
    product = random_product_belief(model, fp.Simulation(model).start(rng), rng)
    state = sampled_state(product, rng)
    assert set(state) == {variable.name for variable in model.states}
    assert joint_of(product).table.value(state) > 0
    listed = spelled_out(product)
    assert {name for names in listed for name in names.split(", ")} == set(state)


@pytest.mark.example
def test_what_was_found_is_told_after_every_comparison() -> None:
    told = list(verifications(fp.domain("tiger"), 2, 3, np.random.default_rng(0), runs=2))
    assert [(found.beliefs, found.steps) for found in told] == [(1, 0), (2, 0), *((2, n) for n in range(1, 7))]
    assert isinstance(told[-1], Verification)
    assert told[-1].joint_seconds > 0


@pytest.mark.example
def test_too_large_is_refused_with_sizes() -> None:
    with pytest.raises(fp.TooLarge, match="207,360,000 joint states, 81 joint actions, 40,401 joint observations"):
        verify(fp.domain("surveillance", site="hall", targets=2), 1, 0, np.random.default_rng(0))
