"""Targets that come and go, and cameras that people have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from surveillance_domain.control.lookahead import LookaheadChooser
from surveillance_domain.control.mdp import MdpController
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.roster import OpenRoster
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import KnownTarget, Operation
from surveillance_domain.world.base import Cell, Sighting


def built(targets: int = 1, known: tuple[str, ...] = ("anna",), forget_s: float = 10.0) -> Surveillance:
    site = load_site("tiny")
    named = tuple(KnownTarget(name=name, marker=None) for name in known)
    site = replace(
        site,
        targets=site.targets.model_copy(update={"known": named}),
        operation=Operation(forget_s=forget_s),
    )
    return surveillance_model(site, targets)


def sighting(surveillance: Surveillance, time_s: float, held: frozenset[str] = frozenset(), **seen: Cell) -> Sighting:
    """Cameras are away, so that a target which is not seen is not contradicted."""
    observations = {target: seen.pop(target, None) for target in surveillance.targets}
    unknown = {name.replace("_", " "): cell for name, cell in seen.items()}
    return Sighting(observations, {c.name: None for c in surveillance.site.cameras}, time_s, held=held, unknown=unknown)


def opened(surveillance: Surveillance) -> PomdpController:
    return PomdpController(surveillance, roster=OpenRoster(surveillance))


def step(controller: PomdpController, seen: Sighting) -> None:
    controller.choose()
    controller.see(seen)


@pytest.mark.example
def test_an_unknown_marker_starts_a_target_where_it_was_seen() -> None:
    surveillance = built()
    controller = opened(surveillance)
    cell = (2, 1)
    step(controller, sighting(surveillance, 1.0, marker_12=cell))
    assert controller.targets == ("anna", "marker 12")
    place = controller.belief.marginal("marker 12.location")
    assert place[surveillance.site.grid.number[cell[1], cell[0]]] == pytest.approx(1.0)
    directions = controller.belief.marginal("marker 12.direction")
    assert (directions > 0).all()  # in the middle of an open floor every direction leads there
    assert controller.choose().value is not None
    step(controller, sighting(surveillance, 2.0))
    assert controller.belief.marginal("marker 12.location").max() < 1.0  # it moves on like the others
    assert controller.roster is not None
    assert (controller.roster.started, controller.roster.ended) == (1, 0)


@pytest.mark.example
def test_a_guest_ends_after_forget_s_and_may_come_back() -> None:
    surveillance = built(forget_s=10.0)
    controller = opened(surveillance)
    step(controller, sighting(surveillance, 1.0, marker_12=(2, 1)))
    step(controller, sighting(surveillance, 11.0))
    assert controller.targets == ("anna", "marker 12")  # ten seconds, not more
    step(controller, sighting(surveillance, 11.5))
    assert controller.targets == ("anna",)
    step(controller, sighting(surveillance, 500.0))
    assert controller.targets == ("anna",)  # the site names her
    step(controller, sighting(surveillance, 501.0, marker_12=(0, 0)))
    assert controller.targets == ("anna", "marker 12")


@pytest.mark.example
def test_all_may_go_and_one_may_come_to_an_empty_floor() -> None:
    surveillance = built(targets=2, known=())
    controller = opened(surveillance)
    step(controller, sighting(surveillance, 0.0))
    step(controller, sighting(surveillance, 20.0))
    assert controller.targets == ()
    assert controller.choose().value == 0.0
    step(controller, sighting(surveillance, 21.0, marker_3=(1, 1)))
    assert controller.targets == ("marker 3",)
    assert controller.belief.marginal("marker 3.location").sum() == pytest.approx(1.0)
    step(controller, sighting(surveillance, 22.0, target2=(0, 0)))  # one of the model's own, met again
    assert controller.targets == ("marker 3", "target2")


@pytest.mark.example
def test_without_an_open_roster_nobody_comes_or_goes() -> None:
    surveillance = built(targets=2, known=())
    controller = PomdpController(surveillance)
    for time_s in (1.0, 1000.0):
        step(controller, sighting(surveillance, time_s, marker_12=(2, 1)))
    assert controller.targets == ("target1", "target2")


@pytest.mark.example
def test_other_controllers_pass_over_who_is_unknown() -> None:
    surveillance = built()
    controller = MdpController(surveillance)
    controller.choose()
    controller.see(sighting(surveillance, 1.0, marker_12=(2, 1)))
    assert controller.choose().value == 0.0


@pytest.mark.example
@pytest.mark.parametrize("ahead", [False, True])
def test_a_held_camera_is_counted_on_where_it_looks_and_not_moved(ahead: bool) -> None:
    """A target stands in sight of one preset of each camera; the one that is held stays, and the other turns."""
    surveillance = built()
    site, views = surveillance.site, surveillance.views
    first = [camera.presets[0].name for camera in site.cameras]
    covers = [camera[1:].max(axis=0) > camera[0] for camera in views.detection]
    column, row = site.grid.cells[int(np.flatnonzero(covers[0])[0])].tolist()
    chooser = LookaheadChooser(surveillance, horizon=2, scenarios=4) if ahead else None
    free, stuck = PomdpController(surveillance, chooser), PomdpController(surveillance)
    names = [camera.name for camera in site.cameras]
    at = dict(zip(names, first, strict=True))
    for controller, held in ((free, frozenset[str]()), (stuck, frozenset(names))):
        controller.choose()
        controller.see(Sighting({"anna": (column, row)}, at, 1.0, held=held))
    assert dict(free.choose().presets) != at
    choice = stuck.choose()
    assert dict(choice.presets) == at
    assert choice.value is not None
    assert choice.value < (free.choose().value or 0.0) + 1e-12
    stuck.see(Sighting({"anna": (column, row)}, at, 2.0))
    assert dict(stuck.choose().presets) != at  # released


@pytest.mark.example
def test_with_guests_the_lookahead_chooses_as_p_does() -> None:
    surveillance = built()
    controller = PomdpController(
        surveillance, LookaheadChooser(surveillance, horizon=2, scenarios=4), OpenRoster(surveillance)
    )
    at = {camera.name: camera.presets[0].name for camera in surveillance.site.cameras}
    controller.choose()
    controller.see(Sighting({"anna": None}, at, 1.0, unknown={"marker 12": (2, 1)}))
    controller.choose()
    controller.see(Sighting({"anna": None}, at, 2.0))
    assert set(controller.targets) == {"anna", "marker 12"}
