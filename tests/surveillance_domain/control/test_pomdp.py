"""The controller P: its belief after hand-made sightings, cameras that are away, ties, slew."""

from __future__ import annotations

import numpy as np
import pytest

from surveillance_domain.control.loop import run_loop
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.experiments.runs import simulated_world
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.world.base import Sighting
from tests.hand_made import altered, hand_made

STILL = {"directions": 1, "speeds_mps": (0.0,)}
"""Targets that do not move: the predicted belief is the belief."""


def believing(surveillance: Surveillance, *mass: list[float], **known: str | None) -> PomdpController:
    """A controller whose belief has these masses of cells, one list a target (spread evenly over all else)."""
    controller = PomdpController(surveillance)
    belief = controller.belief
    cells = np.array(mass).T
    share = len(belief.arrays[0]) // len(cells)
    array = np.repeat(cells / share, share, axis=0)
    actual = {**belief.known, **{f"{camera}.preset": preset for camera, preset in known.items()}}
    controller.belief = belief.with_arrays([array], actual)
    return controller


def cell_mass(controller: PomdpController, target: str = "target1") -> list[float]:
    return pytest.approx(controller.belief.marginal(f"{target}.location").tolist(), abs=1e-12)


@pytest.mark.example
def test_it_looks_where_most_mass_is_and_says_what_it_expects():
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3, 4]}}, 2, **STILL)
    controller = believing(built, [0.4, 0.2, 0.2, 0.1, 0.1], [0, 0.1, 0.3, 0.6, 0])
    choice = controller.choose()
    assert choice.presets == {"a": "right"}
    assert choice.value == pytest.approx(0.2 + 0.6)
    assert choice.upper_bound == pytest.approx(choice.value)


@pytest.mark.example
def test_it_learns_from_silence_and_from_sightings():
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3, 4]}}, 2, detection=0.8, **STILL)
    controller = believing(built, [0.2] * 5, [0.2] * 5)
    assert controller.choose().presets == {"a": "left"}
    controller.see(Sighting({"target1": None, "target2": (1, 0)}, {"a": "left"}, 1.0))
    assert cell_mass(controller) == [0.04 / 0.68, 0.04 / 0.68, 0.2 / 0.68, 0.2 / 0.68, 0.2 / 0.68]
    assert cell_mass(controller, "target2") == [0, 1, 0, 0, 0]
    assert controller.restarts == 0
    assert controller.belief.exact


@pytest.mark.example
def test_the_actual_view_counts_not_the_one_asked_for():
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3, 4]}}, **STILL)
    controller = believing(built, [0.4, 0.2, 0.2, 0.1, 0.1])
    assert controller.choose().presets == {"a": "left"}
    controller.see(Sighting({"target1": None}, {"a": "right"}, 1.0))
    assert cell_mass(controller) == [0.5, 0.25, 0.25, 0, 0]
    assert controller.belief.known == {"a.preset": "right"}


@pytest.mark.example
def test_ties_keep_the_present_preset_then_take_the_first():
    views = {"a": {"one": [0], "two": [1], "three": [2]}, "b": {"one": [3], "two": [3]}}
    built = hand_made(["....."], views, **STILL)
    assert believing(built, [0, 0.5, 0.5, 0, 0], a="three").choose().presets == {"a": "three", "b": "one"}
    assert believing(built, [0, 0.5, 0.5, 0, 0], a="one", b="two").choose().presets == {"a": "two", "b": "two"}
    assert believing(built, [0, 0, 0, 0, 1.0], a="two", b="two").choose().presets == {"a": "two", "b": "two"}


# ------------------------------------------------------------------------------------------------------ cameras away
VIEWS = {"a": {"left": [0, 1], "right": [3, 4]}, "b": {"left": [0, 1], "right": [3, 4]}}


@pytest.mark.example
def test_silence_of_a_camera_that_is_away_says_nothing_about_its_cells():
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3, 4]}, "b": {"only": [2]}}, **STILL)
    controller = believing(built, [0.4, 0.2, 0.2, 0.1, 0.1])
    assert controller.choose().presets == {"a": "left", "b": "only"}
    controller.see(Sighting({"target1": None}, {"a": None, "b": "only"}, 1.0))
    assert cell_mass(controller) == [0.5, 0.25, 0, 0.125, 0.125]
    assert controller.belief.known == {"a.preset": None, "b.preset": "only"}
    assert controller.restarts == 0


@pytest.mark.example
def test_with_all_cameras_away_silence_says_nothing_and_the_presets_stand():
    built = hand_made(["....."], VIEWS, **STILL)
    controller = believing(built, [0.4, 0.2, 0.2, 0.1, 0.1])
    asked = controller.choose().presets
    controller.see(Sighting({"target1": None}, {"a": None, "b": None}, 1.0))
    assert cell_mass(controller) == [0.4, 0.2, 0.2, 0.1, 0.1]
    choice = controller.choose()
    assert choice.presets == asked
    assert choice.value == choice.upper_bound == 0


@pytest.mark.example
def test_the_choice_does_not_count_on_a_camera_that_is_away_and_counts_on_it_again_when_it_is_back():
    """With both cameras one watches each end; with ``a`` away, ``b`` must take the better end itself."""
    built = hand_made(["....."], VIEWS, **STILL)
    controller = believing(built, [0.4, 0.2, 0.1, 0.2, 0.1])
    both = controller.choose()
    assert set(both.presets.values()) == {"left", "right"}
    assert both.value == pytest.approx(0.9)
    watches_left = next(camera for camera, preset in both.presets.items() if preset == "left")
    other = "b" if watches_left == "a" else "a"

    alone = believing(built, [0.4, 0.2, 0.1, 0.2, 0.1], **{watches_left: None, other: "right"})
    choice = alone.choose()
    assert choice.presets[other] == "left"
    assert choice.value == pytest.approx(0.6)
    assert choice.upper_bound == pytest.approx(0.6)

    alone.see(Sighting({"target1": None}, {watches_left: "left", other: "left"}, 1.0))
    assert cell_mass(alone) == [0, 0, 1 / 4, 1 / 2, 1 / 4]
    assert alone.choose().value == pytest.approx(0.75)
    assert "right" in alone.choose().presets.values()


@pytest.mark.example
def test_a_camera_that_is_away_keeps_the_preset_that_it_was_sent_to():
    built = hand_made(["....."], {"a": {"left": [0, 1], "right": [3, 4]}, "b": {"only": [2]}}, **STILL)
    controller = believing(built, [0.1, 0.1, 0.2, 0.4, 0.2])
    assert controller.choose().presets["a"] == "right"
    controller.see(Sighting({"target1": None}, {"a": None, "b": "only"}, 1.0))
    controller.belief = controller.belief.with_arrays([np.array([[0.8], [0.2], [0], [0], [0]])])
    assert controller.choose().presets["a"] == "right"
    controller.see(Sighting({"target1": None}, {"a": None, "b": "only"}, 2.0))
    assert controller.choose().presets["a"] == "right"
    controller.see(Sighting({"target1": None}, {"a": "right", "b": "only"}, 3.0))
    assert controller.choose().presets["a"] == "left"


@pytest.mark.example
def test_under_slew_the_others_keep_to_what_they_reach_and_the_one_that_is_back_starts_from_where_it_is():
    views = {"a": {"1": [0], "2": [1], "3": [2]}, "b": {"1": [0], "2": [1], "3": [2]}}
    built = hand_made(["..."], views, pan_deg_per_s=10.0, **STILL)
    controller = believing(built, [0.1, 0.3, 0.6], a=None, b="1")
    assert controller.choose().presets == {"a": "1", "b": "2"}
    controller = believing(built, [0.1, 0.3, 0.6], a=None, b="2")
    assert controller.choose().presets == {"a": "1", "b": "3"}
    back = believing(built, [0.6, 0.1, 0.3], a="3", b="1")
    assert back.choose().presets == {"a": "3", "b": "1"}


class Outage:
    """A simulated world whose camera ``name`` is dead during some steps: the same seed with and without its eyes."""

    def __init__(self, site, name: str, dead: set[int], targets: int) -> None:
        whole, blind = surveillance_model(site, targets), surveillance_model(site, targets)
        number = [camera.name for camera in site.cameras].index(name)
        blind.views.detection[number][:] = 0
        self.surveillance, self.name, self.dead, self.step = whole, name, dead, 0
        self.worlds = [simulated_world(built, "grid", 4, 0) for built in (whole, blind)]
        self.asked: list[str] = []

    def move(self, presets: dict[str, str]) -> None:
        self.asked.append(presets[self.name])
        for world in self.worlds:
            world.move(presets)

    def observe(self) -> Sighting:
        whole, blind = (world.observe() for world in self.worlds)
        self.step += 1
        if self.step not in self.dead:
            return whole
        return Sighting(blind.observations, {**blind.views, self.name: None}, blind.time_s, blind.static)


@pytest.mark.example
@pytest.mark.parametrize("pan_deg_per_s", [None, 30.0])
def test_a_night_with_an_outage_needs_no_restarts(pan_deg_per_s):
    """The truth moves by the model's chain, so no sighting is ever impossible, dead camera or not."""
    site = altered("tiny", cameras={"*": {"pan_deg_per_s": pan_deg_per_s}})
    dead = set(range(10, 25)) | {40}
    world = Outage(site, "south-west", dead, 3)
    controller = PomdpController(world.surveillance)
    record = run_loop(world, controller, 60)
    assert controller.restarts == 0
    assert controller.belief.exact
    assert len(set(world.asked[10:25])) == 1  # the choices after steps 10 ... 24
    assert len(set(world.asked)) > 1
    assert [step.sighting.views["south-west"] is None for step in record] == [n in dead for n in range(1, 61)]


# ----------------------------------------------------------------------------------------------------------- zero mass
@pytest.mark.example
def test_a_target_seen_where_it_cannot_be_starts_anew_there_and_is_counted():
    """One cell a step along a row; seen four cells away. It can have come from either side: east or west."""
    built = hand_made(["......."], {"a": {"all": range(7)}}, 2, sigma_direction_deg=45.0)
    controller = believing(built, [1.0, 0, 0, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0, 1.0])
    controller.choose()
    controller.see(Sighting({"target1": (4, 0), "target2": (5, 0)}, {"a": "all"}, 1.0))
    assert controller.restarts == 1
    assert not controller.belief.exact
    assert "restarted: target1.location, target1.direction, target1.speed" in controller.belief.approximations
    assert cell_mass(controller) == [0, 0, 0, 0, 1, 0, 0]
    assert controller.belief.marginal("target1.direction").tolist() == pytest.approx([0.5, 0, 0.5, 0])
    assert cell_mass(controller, "target2") == [0, 0, 0, 0, 0, 1, 0]
    assert controller.belief.marginal("target2.direction").tolist() == pytest.approx([0, 0, 1, 0])


@pytest.mark.example
def test_at_the_end_of_a_row_only_the_way_in_leads_there():
    built = hand_made(["......."], {"a": {"all": range(7)}}, sigma_direction_deg=45.0)
    controller = believing(built, [1.0, 0, 0, 0, 0, 0, 0])
    controller.choose()
    controller.see(Sighting({"target1": (6, 0)}, {"a": "all"}, 1.0))
    assert controller.belief.marginal("target1.direction").tolist() == pytest.approx([1, 0, 0, 0])


@pytest.mark.example
def test_a_target_not_seen_though_all_its_mass_is_in_view_hides_nearby():
    """Longest move 1 cell, plus one: cells 0 ... 4 about its old place 2, of which 3 and 4 are out of view; not 5."""
    built = hand_made(["......."], {"a": {"left": [0, 1, 2]}}, directions=1, speeds_mps=(0.0, 1.0), walls="stay")
    controller = PomdpController(built)
    inside = np.zeros((7, 1, 2, 1))
    inside[2, 0, 0] = 1.0  # at speed 0, which it keeps
    controller.belief = controller.belief.with_arrays([inside.reshape(-1, 1)])
    controller.choose()
    controller.see(Sighting({"target1": None}, {"a": "left"}, 1.0))
    assert controller.restarts == 1
    assert cell_mass(controller) == [0, 0, 0, 0.5, 0.5, 0, 0]
    assert controller.belief.marginal("target1.speed").tolist() == pytest.approx([0.5, 0.5])


@pytest.mark.example
def test_with_nothing_hidden_nearby_it_is_anywhere_out_of_view():
    built = hand_made(["......."], {"a": {"left": [0, 1, 2, 3, 4]}}, **STILL)
    controller = believing(built, [1.0, 0, 0, 0, 0, 0, 0])
    controller.choose()
    controller.see(Sighting({"target1": None}, {"a": "left"}, 1.0))
    assert cell_mass(controller) == [0, 0, 0, 0, 0, 0.5, 0.5]
    assert controller.restarts == 1


@pytest.mark.example
def test_with_nothing_out_of_view_the_prediction_stands():
    built = hand_made(["..."], {"a": {"all": [0, 1, 2]}}, **STILL)
    controller = believing(built, [0.2, 0.3, 0.5])
    controller.choose()
    controller.see(Sighting({"target1": None}, {"a": "all"}, 1.0))
    assert cell_mass(controller) == [0.2, 0.3, 0.5]
    assert controller.restarts == 1


@pytest.mark.example
def test_weak_eyes_are_never_contradicted_by_silence():
    built = hand_made(["..."], {"a": {"all": [0, 1, 2]}}, detection=0.9, **STILL)
    controller = believing(built, [0.2, 0.3, 0.5])
    controller.choose()
    controller.see(Sighting({"target1": None}, {"a": "all"}, 1.0))
    assert cell_mass(controller) == [0.2, 0.3, 0.5]
    assert controller.restarts == 0


@pytest.mark.example
def test_a_sighting_beyond_the_kernels_reach_starts_anew():
    """σ = 0.4 cells reaches one cell (three sigmas are 1.2), so what is in cell 0 is reported in cell 1, not in 3."""
    built = hand_made(["....."], {"a": {"all": range(5)}}, noise_m={"a": 0.4}, **STILL)
    for cell, restarts in ((1, 0), (3, 1)):
        controller = believing(built, [1.0, 0, 0, 0, 0])
        controller.choose()
        controller.see(Sighting({"target1": (cell, 0)}, {"a": "all"}, 1.0))
        assert controller.restarts == restarts
        assert controller.belief.marginal("target1.location").argmax() == (3 if restarts else 0)


@pytest.mark.example
def test_a_sighting_outside_of_the_free_cells_is_refused():
    built = hand_made([".#."], {"a": {"all": [0, 1]}}, **STILL)
    controller = PomdpController(built)
    controller.choose()
    with pytest.raises(ValueError, match=r"'target1.sighting' has no value \(1, 0\)"):
        controller.see(Sighting({"target1": (1, 0)}, {"a": "all"}, 1.0))


@pytest.mark.property
@pytest.mark.parametrize("walls", ["reject", "reflect", "stay"])
def test_hand_made_nonsense_never_breaks_a_belief(walls):
    """Random sightings, possible or not, and cameras that come and go: beliefs stay distributions."""
    built = surveillance_model(altered("tiny", walls=walls, cameras={"*": {"pan_deg_per_s": 40.0}}), 3)
    rng = np.random.default_rng(8)
    controller = PomdpController(built)
    cells = [tuple(map(int, cell)) for cell in built.site.grid.cells]
    for step in range(60):
        presets = controller.choose().presets
        observations = {t: None if rng.random() < 0.5 else cells[rng.integers(20)] for t in built.targets}
        views = {camera: None if rng.random() < 0.2 else preset for camera, preset in presets.items()}
        beyond = {t: "south-west" for t, cell in observations.items() if cell is not None and rng.random() < 0.5}
        controller.see(Sighting(observations, views, float(step + 1), beyond=beyond))
        for array in controller.belief.arrays:
            assert np.isfinite(array).all()
            assert (array >= 0).all()
            assert np.abs(array.sum(axis=0) - 1).max() < 1e-9
    assert controller.restarts > 10
