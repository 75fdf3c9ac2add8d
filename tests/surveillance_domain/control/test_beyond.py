"""Targets that a picture shows beyond the views of the model."""

from __future__ import annotations

import itertools
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surveillance_domain.control.lookahead import LookaheadChooser
from surveillance_domain.control.mdp import MdpController
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.roster import OpenRoster
from surveillance_domain.model.build import Surveillance
from surveillance_domain.site.sections import Operation, StaticCamera
from surveillance_domain.world.base import Cell, Sighting
from tests.hand_made import hand_made

ROW = ["......."]
STILL = {"directions": 1, "speeds_mps": (0.0,)}
LEFT = {"a": {"left": [0, 1]}}
"""Camera a has the two leftmost cells in view."""


def told(
    surveillance: Surveillance, mass: list[float], sighting: Sighting, *others: list[float], roster: bool = False
) -> PomdpController:
    """A controller that believed its targets at cells with some mass, even over all else, after one step."""
    controller = PomdpController(surveillance, roster=OpenRoster(surveillance) if roster else None)
    cells = np.array([mass, *others]).T
    share = len(controller.belief.arrays[0]) // len(cells)
    controller.belief = controller.belief.with_arrays([np.repeat(cells / share, share, axis=0)])
    controller.choose()
    controller.see(sighting)
    return controller


def places(controller: PomdpController, target: str = "target1") -> list[float]:
    return pytest.approx(controller.belief.marginal(f"{target}.location").tolist(), abs=1e-12)


@pytest.mark.example
def test_where_it_was_thought_to_be_it_is_the_prediction_there_and_no_restart() -> None:
    """From cell 2 heading east or west (a cell a step, no turning): in cell 3 it can only be heading east."""
    built = hand_made(ROW, LEFT, sigma_direction_deg=0.0)
    seen = Sighting({"target1": (3, 0)}, {"a": "left"}, 1.0, beyond={"target1": "a"})
    controller = told(built, [0, 0, 1, 0, 0, 0, 0], seen)
    assert places(controller) == [0, 0, 0, 1, 0, 0, 0]
    assert controller.belief.marginal("target1.direction").tolist() == pytest.approx([1, 0, 0, 0])
    assert (controller.restarts, controller.restarted, controller.belief.exact) == (0, (), True)


@pytest.mark.example
def test_where_it_cannot_be_it_starts_anew_with_every_direction_that_leads_there() -> None:
    built = hand_made(ROW, LEFT, sigma_direction_deg=0.0)
    seen = Sighting({"target1": (5, 0)}, {"a": "left"}, 1.0, beyond={"target1": "a"})
    controller = told(built, [1, 0, 0, 0, 0, 0, 0], seen)
    assert places(controller) == [0, 0, 0, 0, 0, 1, 0]
    assert controller.belief.marginal("target1.direction").tolist() == pytest.approx([0.5, 0, 0.5, 0])
    assert (controller.restarts, controller.restarted, controller.belief.exact) == (1, ("target1",), False)


@pytest.mark.example
def test_silence_about_the_others_says_what_it_always_says() -> None:
    """Of target 2 the empty view of cells 0 and 1 tells; target 1 is seen by ``a`` in a cell that ``b`` has in view."""
    built = hand_made(ROW, {**LEFT, "b": {"only": [4]}}, 2, **STILL)
    views = {"a": "left", "b": "only"}
    seen = Sighting({"target1": (4, 0), "target2": None}, views, 1.0, beyond={"target1": "a"})
    controller = told(built, [0, 0.5, 0, 0, 0.5, 0, 0], seen, [0.5, 0.25, 0.125, 0, 0, 0, 0.125])
    assert places(controller) == [0, 0, 0, 0, 1, 0, 0]
    assert places(controller, "target2") == [0, 0, 0.5, 0, 0, 0, 0.5]
    assert controller.restarts == 0


@pytest.mark.example
@pytest.mark.parametrize(("mass", "restarts"), [([0, 0, 0, 0, 1, 3, 0], 0), ([0, 0, 0, 0, 0, 0, 4], 1)])
def test_the_error_of_the_camera_that_saw_it_counts(mass: list[float], restarts: int) -> None:
    """σ = 0.4 cells: 1.25 σ are half a cell, so cells 4 and 5 report cell 4 with these shares; cell 6 is too far."""
    built = hand_made(ROW, {**LEFT, "b": {"left": [0]}}, noise_m={"a": 0.4}, **STILL)
    seen = Sighting({"target1": (4, 0)}, {"a": "left", "b": "left"}, 1.0, beyond={"target1": "a"})
    controller = told(built, [one / 4 for one in mass], seen)
    own = math.erf(1.25 / math.sqrt(2))
    beside = (math.erf(3.75 / math.sqrt(2)) - own) / 2
    weights = [0, 0, 0, 0, 1 * own, 3 * beside, 0]
    assert places(controller) == ([0, 0, 0, 0, 1, 0, 0] if restarts else [one / sum(weights) for one in weights])
    assert controller.restarts == restarts


@pytest.mark.example
def test_a_cell_that_is_not_free_is_refused() -> None:
    built = hand_made([".#."], {"a": {"left": [0]}}, **STILL)
    with pytest.raises(ValueError, match=r"no value \(1, 0\)"):
        told(built, [0.5, 0.5], Sighting({"target1": (1, 0)}, {"a": "left"}, 1.0, beyond={"target1": "a"}))


def open_floor() -> Surveillance:
    """Nobody is named, and who is not seen for ten seconds is forgotten."""
    built = hand_made(ROW, LEFT, **STILL)
    targets = built.site.targets.model_copy(update={"known": ()})
    return replace(built, site=replace(built.site, targets=targets, operation=Operation(forget_s=10.0)))


@pytest.mark.example
def test_strangers_come_and_stay_by_what_is_seen_beyond_too() -> None:
    built = open_floor()
    controller = told(built, [0, 0, 0, 0, 0, 0.5, 0.5], Sighting({"target1": None}, {"a": "left"}, 0.0), roster=True)
    for time_s, cell in ((8.0, (5, 0)), (16.0, (5, 0))):
        seen = Sighting(
            {"target1": cell},
            {"a": "left"},
            time_s,
            unknown={"marker 9": (3, 0)},
            beyond={"target1": "a", "marker 9": "a"},
        )
        controller.choose()
        controller.see(seen)
        assert controller.targets == ("target1", "marker 9")
        assert places(controller) == [0, 0, 0, 0, 0, 1, 0]
        assert places(controller, "marker 9") == [0, 0, 0, 1, 0, 0, 0]
    assert controller.restarts == 0
    controller.choose()
    controller.see(Sighting({"target1": None}, {"a": "left"}, 27.0))
    assert controller.targets == ()


@pytest.mark.example
@pytest.mark.parametrize("name", ["pomdp", "lookahead", "mp", "msp"])
def test_every_controller_goes_by_it(name: str) -> None:
    """A still target is seen in cell 6, which the preset on the left has not in view: the next look is to the right."""
    overhead = StaticCamera(name="s", position_m=(0.0, 0.0, 3.0), noise_m=(0.0, 0.0))
    built = hand_made(ROW, {"a": {"left": [0, 1], "right": [6]}}, static=[overhead], **STILL)
    controller = {
        "pomdp": lambda: PomdpController(built),
        "lookahead": lambda: PomdpController(built, LookaheadChooser(built, horizon=2, scenarios=4)),
        "mp": lambda: MdpController(built),
        "msp": lambda: MdpController(built, static=True),
    }[name]()
    assert controller.choose().presets == {"a": "left"}
    controller.see(Sighting({"target1": (6, 0)}, {"a": "left"}, 1.0, {"target1": (0, 0)}, beyond={"target1": "a"}))
    choice = controller.choose()
    assert choice.presets == {"a": "right"}
    assert choice.value == pytest.approx(1.0)


VIEWS = {"a": {"left": [0, 1], "right": [4]}, "b": {"top": [3, 4], "none": [2]}}
EYES = {"a": 0.8, "b": 0.7}
TWO_ROWS = ["...", ".#."]


@pytest.mark.property
@settings(max_examples=25, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_it_is_the_joint_prediction_times_what_was_seen(seed: int) -> None:
    """Two targets, every joint state written out; at random in view, seen beyond, or not seen, along a true run."""
    rng = np.random.default_rng(seed)
    built = small_floor()
    moves = moved_by(built)
    states = list(itertools.product(range(5), range(4)))  # cell, direction
    joint = np.full((len(states), len(states)), 1 / len(states) ** 2)
    truth = [int(rng.integers(len(states))) for _ in built.targets]
    controller = PomdpController(built)
    for step in range(1, 6):
        truth = [int(rng.choice(len(states), p=moves[one])) for one in truth]
        views = {camera: rng.choice(list(presets)) if rng.random() < 0.9 else None for camera, presets in VIEWS.items()}
        likelihoods, observations, beyond = [], {}, {}
        for target, state in zip(built.targets, truth, strict=True):
            missed = [chance_missed(views, one) for one in range(5)]
            cell = states[state][0]
            here = np.array([float(one == cell) for one, _ in states])
            seen_in_view, seen_beyond = rng.random() > missed[cell], rng.random() < 0.5
            observations[target] = cell_at(built, cell) if seen_in_view or seen_beyond else None
            if seen_in_view:
                likelihoods.append(here * (1 - missed[cell]))
            elif seen_beyond:
                likelihoods.append(here)
                beyond[target] = "a"
            else:
                likelihoods.append(np.array([missed[one] for one, _ in states]))
        controller.choose()
        controller.see(Sighting(observations, views, float(step), beyond=beyond))
        joint = np.einsum("ij,ik,jl->kl", joint, moves, moves, optimize=True) * np.outer(*likelihoods)
        joint /= joint.sum()
        own = [controller.belief.block(f"{target}.location").array.reshape(-1) for target in built.targets]
        assert np.abs(np.outer(*own) - joint).max() < 1e-9
    assert controller.restarts == 0


@cache
def small_floor() -> Surveillance:
    return hand_made(TWO_ROWS, VIEWS, 2, detection=EYES, sigma_direction_deg=60.0)


def chance_missed(views: dict[str, str | None], cell: int) -> float:
    """That no camera detects a target in a cell."""
    return math.prod(1 - EYES[c] * (preset is not None and cell in VIEWS[c][preset]) for c, preset in views.items())


def cell_at(built: Surveillance, number: int) -> Cell:
    column, row = built.site.grid.cells[number].tolist()
    return column, row


@cache
def moved_by(built: Surveillance) -> np.ndarray:
    """P(cell, direction after | cell, direction before), number by number from the model's factors."""
    model = built.model
    place, heading, speed = (model.variable(f"target1.{part}") for part in ("location", "direction", "speed"))
    pace = speed.values[0]
    table = np.empty((place.size * heading.size, place.size * heading.size))
    states = list(itertools.product(place.values, heading.values))
    for row, (cell, direction) in enumerate(states):
        for column, (to, turned) in enumerate(states):
            at = {place.name: cell, heading.name: direction, speed.name: pace, speed.next.name: pace}
            at |= {place.next.name: to, heading.next.name: turned}
            factors = [model.transition[f"target1.{part}"] for part in ("location", "direction", "speed")]
            table[row, column] = math.prod(f.value({v.name: at[v.name] for v in f.scope}) for f in factors)
    return table
