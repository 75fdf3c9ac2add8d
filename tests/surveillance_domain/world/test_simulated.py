"""The simulated world: what its eyes report against the model, common random numbers, slew, static cameras."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.stats import chisquare, kstest

from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import UNSEEN, Surveillance, surveillance_model
from surveillance_domain.site.sections import StaticCamera
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.simulated import SimulatedWorld
from tests.hand_made import altered, hand_made


@dataclass(frozen=True)
class Still:
    """Targets that stay where they are."""

    cells: np.ndarray
    grid: object

    @property
    def directions(self) -> np.ndarray:
        return np.zeros(len(self.cells), dtype=np.int64)

    speeds = directions

    @property
    def positions_m(self) -> np.ndarray:
        return self.grid.centres_m[self.cells]

    def step(self) -> Still:
        return self


def standing(surveillance: Surveillance, cells: list[int], seed: int = 0) -> SimulatedWorld:
    truth = Still(np.array(cells), surveillance.site.grid)
    return SimulatedWorld(surveillance, truth, np.random.default_rng(seed))


EYES = {
    "weak": ({"a": 0.7, "b": 0.5}, {}),
    "noisy": ({"a": 1.0, "b": 1.0}, {"a": 0.7, "b": 0.4}),
    "weak, the first one noisier": ({"a": 0.7, "b": 0.5}, {"a": 0.8, "b": 0.3}),
    "weak, the second one exact": ({"a": 0.4, "b": 0.6}, {"a": 0.6}),
}


@pytest.mark.example
@pytest.mark.parametrize("eyes", EYES)
@pytest.mark.parametrize("cell", [5, 8])
def test_sightings_follow_the_models_law(eyes, cell):
    """2,500 looks at a target that both cameras (cell 5) or one of them (cell 8) may detect; chi-square, fixed seed."""
    detection, noise = EYES[eyes]
    looks = 2500
    views = {"a": {"one": [0, 1, 4, 5]}, "b": {"one": [2], "other": [5, 8]}}
    built = hand_made(["...", ".#.", "...", "..."], views, 1, detection=detection, noise_m=noise)
    world = standing(built, [cell], seed=3)
    world.move({"b": "other"})
    sighting = built.model.variable("target1.sighting")
    counts = np.zeros(sighting.size)
    for _ in range(looks):
        seen = world.observe().observations["target1"]
        counts[sighting.index(UNSEEN if seen is None else seen)] += 1
    place = built.model.variable("target1.location").values[cell]
    given = {"a.preset.next": "one", "b.preset.next": "other", "target1.location.next": place}
    law = built.model.observation["target1.sighting"].condition(given).array_over([sighting])
    assert counts[law == 0].sum() == 0
    often = law * looks >= 5
    assert often.sum() >= 2
    found = np.append(counts[often], counts[~often].sum())
    expected = np.append(law[often], law[~often].sum()) * looks
    kept = expected > 0
    assert chisquare(found[kept], expected[kept]).pvalue > 0.01


@pytest.mark.example
def test_perfect_eyes_see_exactly_what_is_in_view():
    built = hand_made([".....", "....."], {"a": {"left": [0, 1], "right": [3, 8]}, "b": {"only": [9]}}, 5)
    world = standing(built, [0, 3, 9, 4, 8])
    for presets, seen in (({}, {0, 9}), ({"a": "right"}, {3, 8, 9})):
        world.move(presets)
        sighting = world.observe()
        cells = [tuple(map(int, cell)) for cell in built.site.grid.cells]
        expected = [cells[cell] if cell in seen else None for cell in (0, 3, 9, 4, 8)]
        assert list(sighting.observations.values()) == expected
    assert list(sighting.observations) == list(built.targets)


@pytest.mark.example
def test_cameras_start_at_their_first_preset_and_keep_the_one_they_have():
    built = hand_made(["..."], {"a": {"left": [0], "right": [2]}, "b": {"up": [0], "down": [1]}})
    world = standing(built, [0])
    assert world.observe().views == {"a": "left", "b": "up"}
    world.move({"b": "down"})
    assert world.observe().views == {"a": "left", "b": "down"}
    world.move({})
    sighting = world.observe()
    assert sighting.views == {"a": "left", "b": "down"}
    assert sighting.time_s == 3.0
    assert sighting.static == {}


@pytest.mark.example
def test_presets_that_are_not_there_or_out_of_reach_are_refused_and_nothing_moves():
    built = hand_made(["..."], {"a": {"1": [0], "2": [1], "3": [2]}, "b": {"1": [0], "2": [1]}}, pan_deg_per_s=10.0)
    world = standing(built, [0])
    with pytest.raises(ValueError, match="a does not reach '3' within one step of 1 s"):
        world.move({"b": "2", "a": "3"})
    with pytest.raises(ValueError, match="no camera 'a' with a preset '4' at site drawn"):
        world.move({"a": "4"})
    with pytest.raises(ValueError, match="no camera 'c' with a preset '1'"):
        world.move({"c": "1"})
    assert world.observe().views == {"a": "1", "b": "1"}
    world.move({"a": "2"})
    world.move({"a": "3"})
    assert world.observe().views == {"a": "3", "b": "1"}


def watched(world: SimulatedWorld, presets: list[dict[str, str]]) -> list[Sighting]:
    found = []
    for choice in presets:
        world.move(choice)
        found.append(world.observe())
    return found


@pytest.mark.example
@pytest.mark.parametrize("truth", ["grid", "continuous"])
def test_random_numbers_are_common_to_all_choices_and_numbers_of_targets(truth):
    eyes = {"*": {"detection_probability": 0.6, "cell_noise_m": 0.5}}
    few, many = (surveillance_model(altered("tiny", cameras=eyes), m) for m in (2, 5))
    rng = np.random.default_rng(1)
    names = ("left", "middle", "right")
    one = [{c.name: str(rng.choice(names)) for c in few.site.cameras} for _ in range(80)]
    # The other controller differs in one camera and in every second step only.
    other = [{**p, "south-west": names[step % 2] if step % 2 else p["south-west"]} for step, p in enumerate(one)]
    worlds = [simulated_world(few, truth, 7, 2), simulated_world(few, truth, 7, 2), simulated_world(many, truth, 7, 2)]
    first, second, third = (watched(world, presets) for world, presets in zip(worlds, (one, other, one), strict=True))
    assert np.array_equal(worlds[0].truth.cells, worlds[1].truth.cells)
    assert np.array_equal(worlds[0].truth.cells, worlds[2].truth.cells[:2])
    same = [step for step in range(80) if one[step] == other[step]]
    assert len(same) >= 40
    assert all(first[step].observations == second[step].observations for step in same)
    assert any(first[step].observations != second[step].observations for step in range(80))
    for mine, theirs in zip(first, third, strict=True):
        assert mine.static == {target: theirs.static[target] for target in few.targets}
        assert mine.observations == {target: theirs.observations[target] for target in few.targets}
    again = watched(simulated_world(few, truth, 7, 2), one)
    assert again == first
    assert watched(simulated_world(few, truth, 7, 3), one) != first


@pytest.mark.example
def test_each_camera_has_its_own_luck():
    """Two cameras of 0.5 on one cell: seen in 3 of 4 looks, not in 1 of 2 as if they shared a draw."""
    built = hand_made(["."], {"a": {"one": [0]}, "b": {"one": [0]}}, 1, detection=0.5)
    world = standing(built, [0])
    seen = sum(world.observe().observations["target1"] is not None for _ in range(2000))
    assert abs(seen / 2000 - 0.75) < 4 * np.sqrt(0.75 * 0.25 / 2000)


def overhead(name: str, x: float, sigma: float, kappa: float) -> StaticCamera:
    return StaticCamera(name=name, position_m=(x, 0.5, 3.0), noise_m=(sigma, kappa))


@pytest.mark.example
def test_static_sightings_have_noise_that_grows_with_distance():
    """σ = 0.5 + 0.1 · distance along the floor; on a row of cells the error across it is lost, the other is snapped."""
    row = "." * 61
    far = 30.0  # from x = 0.5 to the centre of cell 30
    built = hand_made([row], {"a": {"one": [0]}}, 2, static=[overhead("s", 0.5, 0.5, 0.1)])
    world = standing(built, [30, 0], seed=5)
    columns = [world.observe().static["target1"][0] for _ in range(1500)]
    errors = np.array(columns) - 30.0
    sigma = 0.5 + 0.1 * far
    jitter = np.random.default_rng(0).uniform(-0.5, 0.5, len(errors))
    assert kstest((errors + jitter) / np.hypot(sigma, 1 / np.sqrt(12)), "norm").pvalue > 0.01
    assert not kstest((errors + jitter) / (1.2 * sigma), "norm").pvalue > 0.01


@pytest.mark.example
def test_static_sightings_come_from_the_surest_camera_that_sees_the_target():
    """A wall parts the row; the exact camera on the left cannot see what stands on the right."""
    built = hand_made(
        ["...#..."], {"a": {"one": [0]}}, 2, static=[overhead("exact", 0.5, 0.0, 0.0), overhead("poor", 0.5, 5.0, 0.0)]
    )
    world = standing(built, [2, 4])
    assert world.observe().static == {"target1": (2, 0), "target2": None}
    noisy = replace(built, site=replace(built.site, static_cameras=(overhead("right", 6.5, 0.0, 0.8),)))
    world = standing(noisy, [2, 3])
    seen = [world.observe().static for _ in range(200)]
    assert all(sighting["target1"] is None for sighting in seen)
    cells = {sighting["target2"] for sighting in seen}
    assert (4, 0) in cells
    assert len(cells) > 2
    free = {tuple(map(int, cell)) for cell in built.site.grid.cells}
    assert cells <= free
