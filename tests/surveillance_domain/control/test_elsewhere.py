"""A camera that people have turned to where it has no preset: its actual view counts, as a preset's there would.

The oracle is a site that has a preset there: the model's own table of observations then says what the view tells.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.experiments.setup import Setup, site_of
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.model.elsewhere import Elsewhere
from surveillance_domain.model.views import build_views
from surveillance_domain.site.sections import PrivateArea
from surveillance_domain.site.site import Site
from surveillance_domain.world.base import Sighting

THERE = "there"


def with_preset(site: Site, place: tuple[float, float, float]) -> Site:
    """The site, its first camera having one more preset."""
    first, *others = site.cameras
    pan, tilt, zoom = place
    more = first.presets[0].model_copy(update={"name": THERE, "pan": pan, "tilt": tilt, "zoom": zoom})
    return with_cameras(site, first.model_copy(update={"presets": (*first.presets, more)}), *others)


def with_cameras(site: Site, *cameras: Any) -> Site:
    return replace(site, cameras=cameras)


def some_sight(site: Site, probability: float) -> Site:
    cameras = [camera.model_copy(update={"detection_probability": probability}) for camera in site.cameras]
    return with_cameras(site, *cameras)


def controllers(site: Site, place: tuple[float, float, float]) -> tuple[PomdpController, PomdpController, Surveillance]:
    """One that has no preset there, one that has, and the latter's model."""
    oracle = surveillance_model(with_preset(site, place), 2)
    return PomdpController(surveillance_model(site, 2)), PomdpController(oracle), oracle


@pytest.mark.property
@settings(max_examples=10)
@given(
    pan=st.sampled_from([-33.0, 12.0, 47.0]),
    probability=st.sampled_from([1.0, 0.7]),
    seed=st.integers(0, 2**16),
)
def test_belief_and_choice_are_those_with_a_preset_there(pan: float, probability: float, seed: int) -> None:
    site = some_sight(site_of(Setup("tiny", 2)), probability)
    preset = site.cameras[0].presets[0]
    place = (pan, preset.tilt, preset.zoom)
    ours, theirs, oracle = controllers(site, place)
    rng = np.random.default_rng(seed)
    first, others = site.cameras[0].name, site.cameras[1:]
    there = Elsewhere(site).detection(first, place)
    assert there is not None
    np.testing.assert_array_equal(there, build_views(oracle.site).detection[0][-1])
    for step in range(4):
        views: dict[str, str | None] = {camera.name: None for camera in others}
        seen: dict[str, Any] = dict.fromkeys(oracle.targets)
        through = {}
        possible = np.flatnonzero((there > 0) & (mass(theirs, "target1") > 0))
        if len(possible) and rng.random() < 0.5:
            column, row = site.grid.cells[rng.choice(possible)].tolist()
            seen["target1"], through["target1"] = (column, row), first
        time_s, held = float(step), frozenset([first])
        ours.see(Sighting(seen, {first: None, **views}, time_s, held=held, through=through, elsewhere={first: place}))
        theirs.see(Sighting(seen, {first: THERE, **views}, time_s, held=held))
        for target in oracle.targets:
            name = f"{target}.location"
            np.testing.assert_allclose(
                ours.belief.block(name).array, theirs.belief.block(name).array, rtol=1e-9, atol=1e-15
            )
        assert ours.restarts == theirs.restarts
    everywhere = {camera.name: camera.presets[0].name for camera in others}
    seeing = Sighting(dict.fromkeys(oracle.targets), {first: None, **everywhere}, 9.0, elsewhere={first: place})
    ours.see(seeing)
    theirs.see(Sighting(seeing.observations, {first: THERE, **everywhere}, 9.0))
    worth = {tuple(sorted(moves.items())): value for moves, value in values(ours, site)}
    for moves, value in values(theirs, oracle.site):
        if moves[f"{first}.move"] == THERE:
            rest = tuple(sorted((move, to) for move, to in moves.items() if move != f"{first}.move"))
            assert worth[rest] == pytest.approx(value, rel=1e-9)


def mass(controller: PomdpController, target: str) -> Any:
    """Of a target in each cell after one step, were nothing seen."""
    moves = {f"{camera}.move": preset for camera, preset in controller.choose().presets.items()}
    return controller.belief.predict(moves).block(f"{target}.location").array.sum(axis=(1, 2))


def values(controller: PomdpController, site: Site) -> Any:
    chooser = PresetChooser(surveillance_model(site, 2))
    return chooser.values(controller.belief, controller.held, controller.missed)


@pytest.mark.example
def test_a_view_that_holds_all_of_a_belief_and_shows_nobody_starts_it_anew_out_of_its_sight() -> None:
    """Perfect eyes: the target is where none of the cameras looks, whatever was thought."""
    site = site_of(Setup("tiny", 1))
    controller = PomdpController(surveillance_model(site, 1))
    first = site.cameras[0]
    place = (first.presets[0].pan + 12.0, first.presets[0].tilt, first.presets[0].zoom)
    there = Elsewhere(site).detection(first.name, place)
    assert there is not None
    inside = np.flatnonzero(there > 0)
    column, row = site.grid.cells[inside[0]].tolist()
    nowhere: dict[str, str | None] = dict.fromkeys((camera.name for camera in site.cameras), None)
    seen = Sighting({"target1": (column, row)}, nowhere, 0.0, beyond={"target1": first.name})
    controller.see(seen)
    for step in range(6):
        controller.see(Sighting({"target1": None}, nowhere, 1.0 + step, elsewhere={first.name: place}))
        located = controller.belief.block("target1.location").array.sum(axis=(1, 2))
        assert located.sum() == pytest.approx(1.0)
        assert located[inside].sum() == 0.0


@pytest.mark.example
def test_a_view_into_a_private_area_is_none() -> None:
    site = site_of(Setup("tiny", 1))
    first = site.cameras[0]
    place = (first.presets[0].pan + 12.0, first.presets[0].tilt, first.presets[0].zoom)
    there = Elsewhere(site).detection(first.name, place)
    assert there is not None
    x, y = site.grid.centres_m[np.flatnonzero(there > 0)[0]].tolist()
    polygon = ((x - 0.2, y - 0.2), (x + 0.2, y - 0.2), (x, y + 0.2))
    private = replace(site, privacy=(PrivateArea(polygon_m=polygon),))
    assert Elsewhere(private).detection(first.name, place) is None
    assert (Elsewhere(private).missed({first.name: place}) == 1).all()
