"""MP and MSP: what they make of sightings, and of what is out of sight."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from surveillance_domain.control.mdp import MdpController
from surveillance_domain.model.build import Surveillance
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.sections import StaticCamera
from surveillance_domain.world.base import Cell, Sighting
from tests.hand_made import hand_made

EVERY = {"watch": {"all": range(25)}}
"""One camera that sees a floor of 5 x 5 cells whole; what it reports is up to the test."""
FLOOR = ["....."] * 5
MOTION = {"sigma_direction_deg": 0.0, "walls": "stay"}
OVERHEAD = StaticCamera(name="s", position_m=(0.0, 0.0, 3.0), noise_m=(0.0, 0.0))


def told(surveillance: Surveillance, *cells: Cell | None, **options) -> MdpController:
    """An MP controller after these sightings of its one target, a second apart."""
    controller = MdpController(surveillance, **options)
    camera = surveillance.site.cameras[0]
    for step, cell in enumerate(cells):
        controller.see(Sighting({"target1": cell}, {camera.name: camera.presets[0].name}, float(step + 1)))
    return controller


@cache
def watchers() -> list[tuple[Cell, MdpController]]:
    """For each cell of the floor a controller whose one camera sees that cell alone."""
    cells = Grid.from_rows(FLOOR, 1.0).cells
    return [
        ((int(column), int(row)), MdpController(hand_made(FLOOR, {"one": {"cell": [number]}}, **MOTION)))
        for number, (column, row) in enumerate(cells)
    ]


def predicted(controller: MdpController) -> dict[Cell, float]:
    """Where it expects its target after the next step, as the value of watching each cell."""
    worth = {}
    for cell, watcher in watchers():
        watcher._estimates = controller._estimates
        value = watcher.choose().value
        if value > 1e-12:
            worth[cell] = value
    return worth


@pytest.mark.example
def test_before_the_first_sighting_nothing_is_expected_and_the_presets_stand():
    built = hand_made(["..."], {"a": {"left": [0], "right": [2]}})
    choice = MdpController(built).choose()
    assert choice.presets == {"a": "left"}
    assert choice.value == 0


@pytest.mark.example
def test_after_one_sighting_the_direction_is_uniform():
    built = hand_made(FLOOR, EVERY, **MOTION)
    found = predicted(told(built, (2, 2)))
    assert found == pytest.approx({(3, 2): 0.25, (2, 3): 0.25, (1, 2): 0.25, (2, 1): 0.25})


@pytest.mark.example
@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [((1, 2), (2, 2), (3, 2)), ((2, 1), (2, 2), (2, 3)), ((3, 2), (2, 2), (1, 2)), ((2, 4), (2, 2), (2, 1))],
)
def test_the_last_two_sightings_give_the_direction(first, second, expected):
    built = hand_made(FLOOR, EVERY, **MOTION)
    assert predicted(told(built, first, second)) == pytest.approx({expected: 1.0})


@pytest.mark.example
def test_the_direction_is_the_nearest_of_the_set():
    """From (0, 0) to (2, 1) it is 27 degrees, which is nearer to 45 than to 0 with eight directions, not with four."""
    for directions, nearest in ((4, 0), (8, 1)):
        built = hand_made(FLOOR, EVERY, directions=directions, **MOTION)
        heading = told(built, (0, 0), (2, 1))._estimates.headings[0]
        assert heading.tolist() == np.eye(directions)[nearest].tolist()


@pytest.mark.example
def test_seen_twice_in_one_cell_the_direction_stays():
    built = hand_made(FLOOR, EVERY, **MOTION)
    assert predicted(told(built, (1, 2), (2, 2), (2, 2))) == pytest.approx({(3, 2): 1.0})
    found = predicted(told(built, (2, 2), (2, 2)))
    assert found == pytest.approx({(3, 2): 0.25, (2, 3): 0.25, (1, 2): 0.25, (2, 1): 0.25})


@pytest.mark.example
def test_the_speed_is_that_of_the_set_nearest_to_the_last_move():
    built = hand_made(FLOOR, EVERY, speeds_mps=(0.0, 1.0, 2.0), **MOTION)
    for cells, pace in (
        (((0, 0), (2, 0)), 2),
        (((0, 0), (1, 0)), 1),
        (((0, 0), (0, 0)), 0),
        (((0, 0), None, (2, 0)), 1),
        (((0, 0), None, None, (1, 0)), 0),
    ):
        assert told(built, *cells)._estimates.paces[0].tolist() == np.eye(3)[pace].tolist()
    assert told(built, (0, 0))._estimates.paces[0].tolist() == [1 / 3] * 3


@pytest.mark.example
def test_sightings_with_one_time_stamp_are_no_motion():
    built = hand_made(FLOOR, EVERY, **MOTION)
    controller = MdpController(built)
    for cell in ((0, 0), (1, 0)):
        controller.see(Sighting({"target1": cell}, {"watch": "all"}, 5.0))
    assert controller._estimates.headings[0].tolist() == [0.25] * 4
    assert controller._estimates.cells[0] == 1


ENDS = {"a": {"left": [0, 1], "middle": [3, 4, 5], "right": [7, 8]}}


@pytest.mark.example
def test_a_target_out_of_sight_is_dropped_and_its_direction_comes_back_with_it():
    built = hand_made(["........."], ENDS, **MOTION)
    east = told(built, (3, 0), (4, 0))
    assert east.choose().value == 1
    gone = told(built, (3, 0), (4, 0), None)
    assert gone.choose().value == 0
    assert gone.choose().presets == {"a": "left"}  # where the camera is
    back = told(built, (3, 0), (4, 0), None, (6, 0))
    assert back.choose().presets == {"a": "right"}
    assert back.choose().value == 1


@pytest.mark.example
def test_held_targets_stay_where_they_were_last_seen():
    built = hand_made(["........."], ENDS, **MOTION)
    held = told(built, (3, 0), (4, 0), None, None, None, out_of_sight="hold")
    assert held.choose().presets == {"a": "middle"}
    assert held.choose().value == 1


@pytest.mark.example
def test_dead_reckoning_goes_straight_on():
    """Seen at 2 and 3, heading east at one cell a second: three seconds later at 6, so next at 7."""
    built = hand_made(["........."], ENDS, **MOTION)
    for missed, cell, preset in ((1, 4, "middle"), (3, 6, "right"), (4, 7, "right"), (9, 8, "left")):
        reckoned = told(built, (2, 0), (3, 0), *[None] * missed, out_of_sight="dead-reckoning")
        assert reckoned._estimates.cells[0] == cell
        # At the wall it is thought to stay: seen by the preset on the right.
        assert reckoned.choose().presets == {"a": "right" if cell == 8 else preset}


@pytest.mark.example
def test_dead_reckoning_keeps_the_pace_whichever_way_it_goes():
    """1.5 cells a second: in four seconds six cells, east and west alike."""
    built = hand_made(["." * 21], {"a": {"all": range(21)}}, speeds_mps=(1.5,), **MOTION)
    for sign in (1, -1):
        reckoned = told(built, (10 - sign, 0), (10, 0), *[None] * 4, out_of_sight="dead-reckoning")
        assert reckoned._estimates.cells[0] == 10 + 6 * sign


@pytest.mark.example
def test_dead_reckoning_stops_at_walls_and_stays_without_a_heading():
    built = hand_made(["....#...."], {"a": {"all": range(8)}}, **MOTION)
    assert told(built, (1, 0), (2, 0), *[None] * 5, out_of_sight="dead-reckoning")._estimates.cells[0] == 3
    assert told(built, (2, 0), *[None] * 5, out_of_sight="dead-reckoning")._estimates.cells[0] == 2


@pytest.mark.example
def test_static_cameras_fill_in_for_msp_alone_and_a_ptz_sighting_is_preferred():
    built = hand_made(FLOOR, EVERY, static=[OVERHEAD], **MOTION)
    views = {"watch": "all"}
    both = Sighting({"target1": (2, 2)}, views, 1.0, {"target1": (4, 4)})
    static = Sighting({"target1": None}, views, 1.0, {"target1": (4, 4)})
    neither = Sighting({"target1": None}, views, 1.0, {"target1": None})
    for helped, sighting, cell in (
        (True, both, 12),
        (True, static, 24),
        (True, neither, -1),
        (False, both, 12),
        (False, static, -1),
    ):
        controller = MdpController(built, static=helped)
        controller.see(sighting)
        assert controller._estimates.cells[0] == cell


@pytest.mark.example
def test_msp_needs_static_cameras():
    with pytest.raises(ValueError, match=r"site drawn has no \[\[static_cameras\]\], which the controller msp needs"):
        MdpController(hand_made(["..."], {"a": {"left": [0]}}), static=True)


@pytest.mark.example
def test_it_does_not_count_on_cameras_that_are_away():
    built = hand_made(["....."], {"a": {"left": [0], "right": [4]}, "b": {"left": [0], "right": [4]}}, 2, **MOTION)
    controller = MdpController(built)
    # Target 1 heads east for cell 4; nothing is known of target 2. Ties keep the present preset where they can.
    for cell in ((2, 0), (3, 0)):
        controller.see(Sighting({"target1": cell, "target2": None}, {"a": None, "b": "left"}, float(cell[0])))
    choice = controller.choose()
    assert choice.presets == {"a": "left", "b": "right"}
    assert choice.value == 1


@pytest.mark.example
def test_it_keeps_to_what_it_reaches():
    built = hand_made(["....."], {"a": {"1": [0], "2": [2], "3": [4]}}, pan_deg_per_s=10.0, **MOTION)
    controller = told(built, (2, 0), (3, 0))
    assert controller.choose().presets == {"a": "1"}  # 4 is out of reach, and 2 sees nothing
    controller.see(Sighting({"target1": (3, 0)}, {"a": "2"}, 9.0))
    assert controller.choose().presets == {"a": "3"}
