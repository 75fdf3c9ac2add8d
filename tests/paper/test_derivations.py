"""The five derivations of the paper's appendix: loops over joint states beside the factored formula and our solvers.

Each scene has a few cells, targets that move among them as they like, and cameras whose presets see some of the cells.
The loops are written from the paper's definitions and use nothing of ours; the null observation outside the joint field
of view has probability one (the last test shows what becomes of the chain if it is 1/|outside|, as printed).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from solvers import DecomposedMyopic, JointMyopic
from tests.small_cameras import UNSEEN, camera_model, in_view, printed_null

Cells = tuple[int, ...]


@dataclass(frozen=True)
class Scene:
    """m targets, n cameras, beliefs b_k, and the presets that an action leads to (τ(ĉ, a) = a)."""

    moves: list[np.ndarray]
    views: list[dict[str, frozenset[int]]]
    beliefs: list[np.ndarray]
    presets: tuple[str, ...]

    @property
    def targets(self) -> range:
        return range(len(self.beliefs))

    @property
    def seen(self) -> frozenset[int]:
        """fov(Ĉ')."""
        return in_view(self.views, self.presets)

    def joint_cells(self) -> Iterator[Cells]:
        """𝒯^m."""
        return itertools.product(range(len(self.beliefs[0])), repeat=len(self.beliefs))

    def joint_sightings(self) -> Iterator[tuple]:
        """𝒵 = 𝒵̇^m."""
        return itertools.product([*range(len(self.beliefs[0])), UNSEEN], repeat=len(self.beliefs))

    def joint_presets(self) -> Iterator[tuple[str, ...]]:
        """𝒞^n."""
        return itertools.product(*self.views)

    def sighting(self, cell: int, presets: tuple[str, ...]) -> Any:
        """What is seen of a target in a cell: the cell inside of the joint field of view, nothing outside."""
        return cell if cell in in_view(self.views, presets) else UNSEEN

    def sees(self, z: Any, cell: int) -> float:
        """P(z_k | t_k, Ĉ')."""
        return float(z == self.sighting(cell, self.presets))

    def predicted(self, target: int, after: int) -> float:
        """Σ_t P(t' | t) b_k(t)."""
        return sum(self.moves[target][now, after] * mass for now, mass in enumerate(self.beliefs[target]))

    def jointly_predicted(self, after: Cells, presets: tuple[str, ...]) -> float:
        """Σ_S P(S' | S, A) B(S), over all joint states with the cameras in them (eq:4, eq:bel)."""
        if presets != self.presets:
            return 0.0
        return sum(
            math.prod(self.moves[k][now[k], after[k]] * self.beliefs[k][now[k]] for k in self.targets)
            for now in self.joint_cells()
        )

    def model(self) -> fp.FactoredPOMDP:
        return camera_model(self.moves, self.views, self.beliefs)

    def action(self) -> dict[str, str]:
        return {f"turn{i}": preset for i, preset in enumerate(self.presets)}

    def observation(self, z: tuple) -> dict[str, Any]:
        return {f"seen{k}": value for k, value in enumerate(z)}


@st.composite
def scenes(draw: st.DrawFn) -> Scene:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    cells, targets = draw(st.sampled_from([(2, 1), (2, 2), (2, 3), (3, 1), (3, 2)]))
    cameras = draw(st.integers(1, 2))
    views = [
        {preset: frozenset(c for c in range(cells) if rng.random() < 0.4) for preset in ("left", "right")}
        for _ in range(cameras)
    ]
    moves = [rng.dirichlet(np.ones(cells), size=cells) for _ in range(targets)]
    beliefs = [rng.dirichlet(np.ones(cells)) for _ in range(targets)]
    return Scene(moves, views, beliefs, tuple(draw(st.sampled_from(["left", "right"])) for _ in range(cameras)))


derivation = pytest.mark.property


def few(test: Any) -> Any:
    return settings(max_examples=12)(given(scenes())(test))


@derivation
@few
def test_the_observation_model_is_a_product_over_targets(scene: Scene) -> None:
    """ap:proof1, eq:obsmodel_ap: P(Z | S) = ∏ P(z_k | l_k, C)."""
    model = scene.model()
    for presets, cells in itertools.product(scene.joint_presets(), scene.joint_cells()):
        truly = tuple(scene.sighting(cell, presets) for cell in cells)
        after = {f"target{k}.next": cell for k, cell in enumerate(cells)}
        after |= {f"camera{i}.next": preset for i, preset in enumerate(presets)}
        total = 0.0
        for z in scene.joint_sightings():
            factored = 1.0
            for k, value in enumerate(z):
                law = model.observation[f"seen{k}"]
                factored *= law.value({**after, f"seen{k}": value})
                assert f"target{k}.next" in law.names
                assert not any(f"target{j}.next" in law.names for j in scene.targets if j != k)
            assert factored == float(z == truly)
            total += factored
        assert total == 1.0


@derivation
@few
def test_the_posterior_is_a_product_over_targets(scene: Scene) -> None:
    """ap:proof2, eq:belfact: B'(S') = ∏ b'_k(t'_k) ∏ δ(c'_i), with b'_k of eq:belup2."""
    model = scene.model()
    predicted = fp.initial_belief(model).predict(scene.action())
    jointly = fp.JointBelief.initial(model).predict(scene.action())
    for z in scene.joint_sightings():
        weights = {
            (cells, presets): math.prod(float(z[k] == scene.sighting(cells[k], presets)) for k in scene.targets)
            * scene.jointly_predicted(cells, presets)
            for cells in scene.joint_cells()
            for presets in scene.joint_presets()
        }
        evidence = sum(weights.values())
        if evidence == 0:
            with pytest.raises(fp.ImpossibleObservation):
                predicted.condition(scene.observation(z))
            continue
        own = [
            [scene.sees(z[k], c) * scene.predicted(k, c) for c in range(len(scene.beliefs[0]))] for k in scene.targets
        ]
        own = [[mass / sum(line) for mass in line] for line in own]
        for (cells, presets), weight in weights.items():
            factored = math.prod(own[k][cells[k]] for k in scene.targets) * float(presets == scene.presets)
            assert weight / evidence == pytest.approx(factored, abs=1e-12)
        after, joint = predicted.condition(scene.observation(z)), jointly.condition(scene.observation(z))
        for k in scene.targets:
            np.testing.assert_allclose(joint.marginal(f"target{k}").array, own[k], atol=1e-12)
            if f"target{k}" in {name for block in after.blocks for name in block}:
                np.testing.assert_allclose(after.marginal(f"target{k}"), own[k], atol=1e-12)


@derivation
@few
def test_the_expected_reward_is_a_sum_over_targets(scene: Scene) -> None:
    """ap:proof3, eq:rew3: R(B) = Σ_S R(S) B(S) = Σ_k R̃(b_k, Ĉ)."""
    jointly = 0.0
    for cells, presets in itertools.product(scene.joint_cells(), scene.joint_presets()):
        belief = math.prod(scene.beliefs[k][cells[k]] for k in scene.targets) * float(presets == scene.presets)
        jointly += belief * sum(cell in in_view(scene.views, presets) for cell in cells)
    factored = sum(sum(b[cell] for cell in scene.seen) for b in scene.beliefs)
    assert jointly == pytest.approx(factored, abs=1e-12)
    stay = Scene([np.eye(len(b)) for b in scene.beliefs], scene.views, scene.beliefs, scene.presets)
    model = stay.model()
    assert DecomposedMyopic(model).value(fp.initial_belief(model), scene.action()) == pytest.approx(factored, abs=1e-12)


@derivation
@few
def test_the_value_is_a_sum_over_targets(scene: Scene) -> None:
    """ap:proof4, eq:valdecomp: V(B, A) = Σ_Z R(B') P(Z | B, A) = Σ_k Ṽ(b_k, Ĉ'), with Ṽ of eq:policy4."""
    jointly = 0.0
    for z in scene.joint_sightings():
        for cells in scene.joint_cells():
            likelihood = math.prod(scene.sees(z[k], cells[k]) for k in scene.targets)
            # R(B') P(Z | B, A): the normaliser of B' is P(Z | B, A) itself
            weight = likelihood * scene.jointly_predicted(cells, scene.presets)
            jointly += weight * sum(cell in scene.seen for cell in cells)
    factored = sum(scene.sees(z, z) * scene.predicted(k, z) for k in scene.targets for z in scene.seen)
    assert jointly == pytest.approx(factored, abs=1e-12)
    model = scene.model()
    assert JointMyopic(model).value(fp.JointBelief.initial(model), scene.action()) == pytest.approx(factored, abs=1e-9)
    assert DecomposedMyopic(model).value(fp.initial_belief(model), scene.action()) == pytest.approx(factored, abs=1e-9)


@derivation
@few
def test_the_evidence_is_a_product_over_targets(scene: Scene) -> None:
    """eqp, eq:etaproof: 1/η = P(Z | B, A) = ∏ P(z_k | b_k, Ĉ') = ∏ 1/η_k."""
    predicted = fp.JointBelief.initial(scene.model()).predict(scene.action())
    total = 0.0
    for z in scene.joint_sightings():
        jointly = sum(
            math.prod(float(z[k] == scene.sighting(cells[k], presets)) for k in scene.targets)
            * scene.jointly_predicted(cells, presets)
            for cells in scene.joint_cells()
            for presets in scene.joint_presets()
        )
        own = [
            sum(scene.sees(z[k], cell) * scene.predicted(k, cell) for cell in range(len(scene.beliefs[0])))
            for k in scene.targets
        ]
        assert jointly == pytest.approx(math.prod(own), abs=1e-12)
        assert predicted.probability(scene.observation(z)) == pytest.approx(jointly, abs=1e-12)
        total += jointly
    assert total == pytest.approx(1.0, abs=1e-12)


def exact_value(masses: list[list[Fraction]], seen: set[int], null: Fraction) -> Fraction:
    """Σ_Z R(B') P(Z | B, A) by loops, with P(null | outside) = ``null``; every posterior is normalised as printed."""
    cells = range(len(masses[0]))
    value = Fraction(0)
    for z in itertools.product([*seen, UNSEEN], repeat=len(masses)):
        weights = {}
        for at in itertools.product(cells, repeat=len(masses)):
            chances = [
                Fraction(z_k == c) if c in seen else null * (z_k == UNSEEN) for z_k, c in zip(z, at, strict=True)
            ]
            weights[at] = math.prod(chances) * math.prod(m[c] for m, c in zip(masses, at, strict=True))
        evidence = sum(weights.values())
        if evidence:
            value += evidence * sum(weight / evidence * sum(c in seen for c in at) for at, weight in weights.items())
    return value


@pytest.mark.example
def test_the_printed_null_observation_breaks_the_chain_at_two_targets() -> None:
    """eq:targetobsprob2 in ap:proof4, in exact fractions: two cells out of view, two targets.

    With a single cell out of view 1/|outside| is one, and nothing breaks.
    """
    half, third, quarter = Fraction(1, 2), Fraction(1, 3), Fraction(1, 4)
    masses = [[half, quarter, quarter], [third, third, third]]
    outside = 2
    printed, ours = exact_value(masses, {0}, Fraction(1, outside)), exact_value(masses, {0}, Fraction(1))
    q = [mass[0] for mass in masses]
    by_formula = sum(q[k] * math.prod(q[j] + (1 - q[j]) / outside for j in range(2) if j != k) for k in range(2))
    assert printed == by_formula == half * Fraction(2, 3) + third * Fraction(3, 4) == Fraction(7, 12)
    assert ours == sum(q) == Fraction(5, 6)
    assert exact_value([[half, half], [third, 2 * third]], {0}, Fraction(1)) == Fraction(5, 6)  # one cell outside

    views = [{"only": frozenset({0})}]
    model = camera_model([np.eye(3)] * 2, views, [np.array([float(p) for p in mass]) for mass in masses])
    belief, action = fp.JointBelief.initial(model), {"turn0": "only"}
    assert JointMyopic(model, likelihood=printed_null(model)).value(belief, action) == pytest.approx(7 / 12, abs=1e-12)
    assert JointMyopic(model).value(belief, action) == pytest.approx(5 / 6, abs=1e-12)
    assert DecomposedMyopic(model).value(fp.initial_belief(model), action) == pytest.approx(5 / 6, abs=1e-12)


@pytest.mark.example
def test_the_printed_null_observation_harms_no_belief() -> None:
    """Its constant cancels in eq:belup: posteriors of both readings are the same."""
    masses = [np.array([0.5, 0.25, 0.25]), np.array([0.2, 0.3, 0.5])]
    model = camera_model([np.eye(3)] * 2, [{"only": frozenset({0})}], masses)
    odd = printed_null(model)
    predicted = fp.JointBelief.initial(model).predict("only")
    for z in itertools.product([0, 1, 2, UNSEEN], repeat=2):
        seen = {"seen0": z[0], "seen1": z[1]}
        weights = np.outer(*masses)
        for k, name in enumerate(seen):
            column = odd[name].condition({"camera0.next": "only", name: z[k]}).dense().array
            weights = weights * np.reshape(column, [-1, 1] if k == 0 else [1, -1])
        if weights.sum() > 0:
            after = predicted.condition(seen).marginal("target0", "target1").array
            np.testing.assert_allclose(weights / weights.sum(), after, atol=1e-15)


@pytest.mark.property
@settings(max_examples=12)
@given(st.integers(0, 2**32 - 1), st.integers(1, 3))
def test_the_printed_value_has_a_closed_form(seed: int, targets: int) -> None:
    """V = Σ_k q_k ∏_{j≠k} (q_j + (1 − q_j)/|outside|), which is Σ_k q_k for one target only."""
    rng = np.random.default_rng(seed)
    beliefs = [rng.dirichlet(np.ones(4)) for _ in range(targets)]
    model = camera_model([np.eye(4)] * targets, [{"only": frozenset({0, 2}), "wide": frozenset({1})}], beliefs)
    solver, belief = JointMyopic(model, likelihood=printed_null(model)), fp.JointBelief.initial(model)
    for preset, seen, outside in (("only", [0, 2], 2), ("wide", [1], 3)):
        q = [b[seen].sum() for b in beliefs]
        closed = sum(
            q[k] * math.prod(q[j] + (1 - q[j]) / outside for j in range(targets) if j != k) for k in range(targets)
        )
        assert solver.value(belief, {"turn0": preset}) == pytest.approx(closed, abs=1e-12)
        assert (abs(closed - sum(q)) > 1e-6) == (targets > 1)


@pytest.mark.example
def test_the_printed_null_observation_may_choose_another_action() -> None:
    """One cell seen surely enough, or three with a little less mass and fewer cells outside."""
    mass = np.array([0.5, 0.45, 0.0, 0.0, 0.05])
    model = camera_model([np.eye(5)] * 2, [{"one": frozenset({0}), "three": frozenset({1, 2, 3})}], [mass, mass])
    belief = fp.JointBelief.initial(model)
    ours, printed = JointMyopic(model).decide(belief), JointMyopic(model, likelihood=printed_null(model)).decide(belief)
    assert (ours.action, ours.value) == ({"turn0": "one"}, pytest.approx(1.0))
    assert (printed.action, printed.value) == ({"turn0": "three"}, pytest.approx(2 * 0.45 * (0.45 + 0.55 / 2)))
