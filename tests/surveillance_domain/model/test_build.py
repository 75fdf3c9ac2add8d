"""The model of a site against its mathematics, by plain loops over motion tables, views and confusion kernels."""

from __future__ import annotations

from itertools import product
from math import prod

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import factored_pomdp as fp
from factored_pomdp.beliefs import initial_belief
from solvers import DecomposedMyopic, JointMyopic
from surveillance_domain.domain import surveillance
from surveillance_domain.model.build import UNSEEN, Surveillance, motion_parameters, surveillance_model, target_names
from surveillance_domain.model.confusion import confusion_kernel
from surveillance_domain.model.motion import motion_tables
from surveillance_domain.site.sections import KnownTarget
from surveillance_domain.world.grid_chain import GridChain
from tests.hand_made import altered, hand_made

SIZES = [
    ("tiny", 2, 230_400, 9, 441),
    ("tiny-3", 3, 419_904, 9, 1_000),
    ("micro", 5, 4_194_304, 4, 3_125),
]
TWO_SPEEDS = {"speeds_mps": (0.5, 1.5), "sigma_speed_mps": 0.6}


def law(model: fp.FactoredPOMDP, name: str, given: dict[str, object]) -> np.ndarray:
    """One line of a conditional distribution, in the order of the child's values."""
    factor = model.transition[name].condition(given) if name in model.transition else model.observation[name]
    child = model.variable(f"{name}.next" if name in model.transition else name)
    return factor.condition(given).array_over([child])


def whole_transition(built: Surveillance, target: str) -> np.ndarray:
    """P(t'|t) of one target as ``[l, d, v, l', d', v']``, multiplied out of the model's factors."""
    model = built.model
    parts = [model.variable(f"{target}.{part}") for part in ("location", "direction", "speed")]
    scope = [*parts, *(part.next for part in parts)]
    letters = dict(zip((variable.name for variable in scope), "ldvLDV", strict=True))
    factors = [model.transition[part.name].dense() for part in parts]
    spelled = ",".join("".join(letters[name] for name in factor.names) for factor in factors)
    sizes = [variable.size for variable in scope]
    return np.broadcast_to(np.einsum(f"{spelled},ldv->ldvLDV", *(f.array for f in factors), np.ones(sizes[:3])), sizes)


@pytest.mark.example
@pytest.mark.parametrize(("site", "targets", "states", "actions", "observations"), SIZES)
def test_sizes_are_those_of_the_design(site, targets, states, actions, observations):
    model = surveillance(site, targets)
    assert (model.joint_states, model.joint_actions, model.joint_observations) == (states, actions, observations)


@pytest.mark.example
@pytest.mark.parametrize("targets", [1, 2, 3, 4, 5])
def test_micro_is_small_enough_for_the_exponential_solver(targets):
    ability = JointMyopic.can_solve(surveillance("micro", targets))
    assert ability, ability.because


@pytest.mark.example
@pytest.mark.parametrize("walls", ["reject", "reflect", "stay"])
@pytest.mark.parametrize(("site", "motion"), [("tiny", {}), ("micro", {}), ("tiny-3", TWO_SPEEDS)], ids=str)
def test_a_targets_transition_is_that_of_the_motion_tables(site, motion, walls):
    """eq:targettransmodel: P(v'|v) P(d'|d,l,v') P(l'|l,d',v'), entry by entry, and the truth's own chain beside it."""
    built = surveillance_model(altered(site, walls=walls, **motion), 2)
    found = whole_transition(built, built.targets[1])
    parameters = motion_parameters(built.site)
    tables = motion_tables(built.site.grid, parameters)
    location = {
        (int(l), int(d), int(v), int(after)): p
        for l, d, v, after, p in zip(  # noqa: E741
            tables.location.cell,
            tables.location.direction,
            tables.location.speed,
            tables.location.next_cell,
            tables.location.probability,
            strict=True,
        )
    }
    chain = GridChain(built.site.grid, parameters)
    for cell, d, v in np.ndindex(*found.shape[:3]):
        expected, drawn = np.zeros(found.shape[3:]), np.zeros(found.shape[3:])
        for after, turned, pace in np.ndindex(*found.shape[3:]):
            turn = tables.direction[d, turned] if walls == "stay" else tables.direction[cell, pace, d, turned]
            expected[after, turned, pace] = tables.speed[v, pace] * turn * location.get((cell, turned, pace, after), 0)
        for pace in range(found.shape[5]):
            outcomes = chain.outcomes(cell, d, pace)
            speed_mass = np.diff((0.0, *chain.next_speeds[v]))[pace]
            for (turned, after), weight in zip(outcomes.pairs, outcomes.weights, strict=True):
                drawn[after, turned, pace] += speed_mass * weight
        assert np.abs(found[cell, d, v] - expected).max() < 1e-12
        assert np.abs(found[cell, d, v] - drawn).max() < 1e-9


EYES = {
    "perfect": {},
    "weak": {"*": {"detection_probability": 0.8}},
    "noisy": {"*": {"cell_noise_m": 0.6}},
    "weak and noisy": {"*": {"detection_probability": 0.8, "cell_noise_m": 0.6}},
    "first one noisier": {
        "south-west": {"detection_probability": 0.6, "cell_noise_m": 0.8},
        "north-east": {"detection_probability": 0.9, "cell_noise_m": 0.0},
    },
    "second one noisier": {
        "south-west": {"detection_probability": 0.6, "cell_noise_m": 0.3},
        "north-east": {"detection_probability": 0.9, "cell_noise_m": 0.8},
    },
}


@pytest.mark.example
@pytest.mark.parametrize("eyes", EYES)
def test_what_is_seen_of_a_target_by_every_set_of_cameras_that_may_detect_it(eyes):
    """P(z|l,C): sum over the sets of detecting cameras; the one with the least noise in the set reports the cell."""
    built = surveillance_model(altered("tiny-3", cameras=EYES[eyes]), 1)
    views, grid, target = built.views, built.site.grid, built.targets[0]
    kernels = [confusion_kernel(grid, noise).toarray() for noise in views.noise_m]
    cells = [tuple(map(int, cell)) for cell in grid.cells]
    partly = 0
    for presets in product(range(3), repeat=2):
        known = {f"{c.name}.preset.next": c.presets[p].name for c, p in zip(built.site.cameras, presets, strict=True)}
        for cell in range(grid.size):
            chances = [views.detection[i][p, cell] for i, p in enumerate(presets)]
            expected = np.zeros(grid.size + 1)
            for detects in product([False, True], repeat=2):
                chance = prod(p if yes else 1 - p for p, yes in zip(chances, detects, strict=True))
                able = [camera for camera, yes in enumerate(detects) if yes]
                if able:
                    reporter = min(able, key=lambda camera: views.noise_m[camera])
                    expected[:-1] += chance * kernels[reporter][cell]
                else:
                    expected[-1] += chance
            found = law(built.model, f"{target}.sighting", {**known, f"{target}.location.next": cells[cell]})
            assert np.abs(found - expected).max() < 1e-12
            assert found[-1] == pytest.approx(prod(1 - p for p in chances), abs=1e-12)
            partly += 0 < found[-1] < 1
    assert (partly > 0) == ("weak" in eyes or "noisier" in eyes)


@pytest.mark.example
def test_the_null_observation_is_certain_outside_of_every_view_and_says_nothing_there():
    """φ has probability 1 outside F (not the printed 1/|F̄|, which is no distribution)."""
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3]}})
    for preset, seen in (("left", {0, 1}), ("right", {3})):
        for cell in range(5):
            line = law(built.model, "target1.sighting", {"a.preset.next": preset, "target1.location.next": (cell, 0)})
            expected = np.zeros(6)
            expected[cell if cell in seen else 5] = 1.0
            assert line.tolist() == expected.tolist()


@pytest.mark.example
def test_observed_targets_are_paid_for():
    model = surveillance("tiny", 2)
    assert set(model.reward) == {"target1.observed", "target2.observed"}
    for name, factor in model.reward.items():
        sighting = name.replace("observed", "sighting")
        assert factor.names == (sighting,)
        paid = {value: factor.value({sighting: value}) for value in model.variable(sighting).values}
        assert paid == {value: float(value != UNSEEN) for value in paid}


@pytest.mark.example
def test_sightings_are_free_cells_or_nothing():
    built = hand_made(["..#", ".#."], {"a": {"left": [0, 1], "right": [3]}})
    assert set(built.model.variable("target1.sighting").values) == {(0, 0), (2, 0), (0, 1), (1, 1), UNSEEN}
    with pytest.raises(ValueError, match=r"'target1.sighting' has no value \(1, 0\)"):
        initial_belief(built.model).predict({"a.move": "left"}).condition({"target1.sighting": (1, 0)})


@pytest.mark.example
def test_cameras_start_at_their_first_preset_and_targets_anywhere():
    model = surveillance("tiny", 1)
    belief = initial_belief(model)
    assert belief.known == {"south-west.preset": "left", "north-east.preset": "left"}
    for name in ("target1.location", "target1.direction", "target1.speed"):
        size = model.variable(name).size
        assert np.abs(belief.marginal(name) - 1 / size).max() < 1e-12


@pytest.mark.example
@pytest.mark.parametrize("options", [{}, {"detection_probability": 0.8, "cell_noise_m": 0.6}], ids=str)
@pytest.mark.parametrize(("site", "targets"), [("tiny", 2), ("tiny-3", 3), ("micro", 5)])
def test_a_block_for_every_target_and_no_ties(site, targets, options):
    model = surveillance(site, targets, **options)
    certificate = fp.decompose(model)
    assert certificate.decomposes
    assert certificate.ties == ()
    assert set(certificate.known) == {v.name for v in model.states if v.name.endswith(".preset")}
    # A single speed makes no numeric difference, yet belongs to its target.
    expected = {tuple(f"target{k}.{x}" for x in ("location", "direction", "speed")) for k in range(1, targets + 1)}
    assert set(certificate.blocks) == expected
    belief = initial_belief(model)
    assert [array.shape[1] for array in belief.arrays] == [targets]


@pytest.mark.property
@settings(max_examples=15)
@given(
    st.sampled_from([("tiny", 2), ("tiny-3", 3), ("micro", 2)]),
    st.sampled_from([1.0, 0.8]),
    st.sampled_from([0.0, 0.6]),
    st.sampled_from([{}, TWO_SPEEDS]),
    st.integers(0, 2**32 - 1),
)
def test_the_value_is_the_mass_that_is_seen(case, detection, noise, motion, seed):
    """V(B,A) = Σ_l w(l) P(seen|l,C'), with w(l) the targets' predicted mass (model.md, "One step looks simpler")."""
    site, targets = case
    eyes = {"*": {"detection_probability": detection, "cell_noise_m": noise}}
    built = surveillance_model(altered(site, cameras=eyes, **motion), targets)
    rng = np.random.default_rng(seed)
    belief = initial_belief(built.model)
    states = len(belief.arrays[0])
    arrays = np.stack([rng.dirichlet(np.full(states, 0.1)) for _ in range(targets)], axis=1)
    belief = belief.with_arrays([arrays])
    weight = np.zeros(built.site.grid.size)
    for number, target in enumerate(built.targets):
        transition = whole_transition(built, target)
        now = arrays[:, number].reshape(transition.shape[:3])
        weight += np.einsum("ldv,ldvLDV->L", now, transition)
    solver, values = DecomposedMyopic(built.model), {}
    for presets in product(*(range(len(camera.presets)) for camera in built.site.cameras)):
        missed = np.ones(len(weight))
        for camera, preset in enumerate(presets):
            missed *= 1 - built.views.detection[camera][preset]
        action = {f"{c.name}.move": c.presets[p].name for c, p in zip(built.site.cameras, presets, strict=True)}
        values[tuple(action.values())] = float(weight @ (1 - missed))
        assert solver.value(belief, action) == pytest.approx(values[tuple(action.values())], abs=1e-12)
    decision = solver.decide(belief)
    assert decision.value == pytest.approx(max(values.values()), abs=1e-12)
    assert values[tuple(decision.action.values())] == pytest.approx(max(values.values()), abs=1e-12)


@pytest.mark.example
def test_slew_limits_the_legal_moves():
    """30 degrees between neighbours, 60 between the outer presets; 40 degrees in a step."""
    built = surveillance_model(altered("tiny", cameras={"south-west": {"pan_deg_per_s": 40.0}}), 1)
    assert set(built.model.legal) == {"south-west.move"}
    reached = {
        (now, then): built.model.is_legal({"south-west.move": then}, {"south-west.preset": now})
        for now in ("left", "middle", "right")
        for then in ("left", "middle", "right")
    }
    assert {pair for pair, yes in reached.items() if not yes} == {("left", "right"), ("right", "left")}
    assert fp.decompose(built.model).decomposes


@pytest.mark.example
@pytest.mark.parametrize("detection", [1.0, 0.8])
def test_under_slew_both_solvers_choose_among_the_reachable(detection):
    built = hand_made(
        ["..."],
        {"a": {"left": [0], "middle": [1], "right": [2]}},
        detection=detection,
        pan_deg_per_s=10.0,
        directions=1,
        speeds_mps=(0.0,),
    )
    belief = initial_belief(built.model)
    mass = np.array([[0.15], [0.25], [0.6]])  # who stands still
    for known, best in (("left", "middle"), ("middle", "right"), ("right", "right")):
        here = belief.with_arrays([mass], {"a.preset": known})
        joint = JointMyopic(built.model)
        table = joint.start().table
        certain = fp.DenseFactor(
            [built.model.variable("a.preset")], [float(v == known) for v in ("left", "middle", "right")]
        )
        parts = here.block("target1.location").product(certain)
        oracle = fp.JointBelief(built.model, fp.DenseFactor(table.scope, parts.array_over(table.scope)))
        found, literal = DecomposedMyopic(built.model).decide(here), joint.decide(oracle)
        assert found.action == literal.action == {"a.move": best}
        assert found.value == pytest.approx(literal.value, abs=1e-12)


@pytest.mark.example
@pytest.mark.parametrize(("detection", "noise"), [(1.0, 0.0), (0.8, 0.6)])
@pytest.mark.parametrize("targets", [1, 2, 3])
def test_on_micro_the_exponential_solver_agrees(targets, detection, noise):
    agree_at_a_random_belief(surveillance("micro", targets, detection, noise), np.random.default_rng(targets))


@pytest.mark.example
@pytest.mark.slow
def test_on_micro_the_exponential_solver_agrees_for_four_targets():
    agree_at_a_random_belief(surveillance("micro", 4, 0.8, 0.6), np.random.default_rng(0))


def agree_at_a_random_belief(model: fp.FactoredPOMDP, rng: np.random.Generator) -> None:
    belief = initial_belief(model)
    states, targets = belief.arrays[0].shape
    belief = belief.with_arrays([np.stack([rng.dirichlet(np.full(states, 0.3)) for _ in range(targets)], axis=1)])
    joint = JointMyopic(model)
    table = joint.start().table
    parts = fp.DenseFactor([], 1.0)
    for name, value in belief.known.items():
        variable = model.variable(name)
        parts = parts.product(fp.DenseFactor([variable], [float(v == value) for v in variable.values]))
    for block in belief.blocks:
        parts = parts.product(belief.block(block[0]))
    literal = joint.decide(fp.JointBelief(model, fp.DenseFactor(table.scope, parts.array_over(table.scope))))
    found = DecomposedMyopic(model).decide(belief)
    assert found.value == pytest.approx(literal.value, abs=1e-9)
    assert found.action == literal.action or DecomposedMyopic(model).value(belief, literal.action) == pytest.approx(
        found.value, abs=1e-9
    )


@pytest.mark.example
def test_targets_share_their_tables():
    model = surveillance("tiny", 20)
    for part in ("location", "direction", "speed"):
        assert len({model.transition[f"target{k}.{part}"].storage for k in range(1, 21)}) == 1
    assert len({model.observation[f"target{k}.sighting"].storage for k in range(1, 21)}) == 1


@pytest.mark.example
def test_targets_are_named_as_the_site_knows_them():
    site = altered("tiny", known=(KnownTarget(name="red"), KnownTarget(name="target3")))
    assert target_names(site, 1) == ("red",)
    assert target_names(site, 4) == ("red", "target3", "target4", "target5")
    assert target_names(altered("tiny", known=(KnownTarget(name="target2"),)), 3) == ("target2", "target3", "target4")
    assert set(surveillance_model(site, 3).model.reward) == {"red.observed", "target3.observed", "target4.observed"}


@pytest.mark.example
@pytest.mark.parametrize("targets", [0, -1])
def test_no_targets_are_refused(targets):
    with pytest.raises(ValueError, match=rf"targets={targets}: expected 1 to 100,000"):
        surveillance_model(altered("tiny"), targets)
