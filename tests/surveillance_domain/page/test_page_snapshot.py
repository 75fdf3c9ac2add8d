"""From a watch to the snapshot of a step, without a browser."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import islice

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.cameras.base import Picture, Position
from surveillance_domain.control.loop import Step
from surveillance_domain.control.watch import Watch
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.page.from_watch import snapshot_of
from surveillance_domain.page.snapshot import Mark, Snapshot
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.observe import Located
from surveillance_domain.world.picture_eyes import Sight
from tests.emulated_watch import Emulated, emulated_watch, lego

HEADINGS = {"left": 130, "middle": 90, "right": 50}
"""Of camera south, in degrees from east: it is mounted facing north, and pans clockwise by -40, 0 and 40 degrees."""


@pytest.fixture
def running() -> Iterator[Emulated]:
    with emulated_watch(lego(), 3, seed=2) as emulated:
        yield emulated


def model(running: Emulated, targets: int = 3) -> Surveillance:
    return surveillance_model(running.emulation.site, targets)


def taken(running: Emulated, steps: int) -> list[tuple[Step, Snapshot]]:
    """Steps, each with its snapshot."""
    surveillance = model(running)
    return [
        (step, snapshot_of(step, running.watch, surveillance, lambda: running.emulation.truth))
        for step in islice(running.watch.turns(), steps)
    ]


@pytest.mark.example
def test_a_snapshot_tells_what_the_step_brought(running: Emulated) -> None:
    presets = ["left", "middle", "right"]
    for step, snapshot in taken(running, 12):
        assert (snapshot.number, snapshot.time_s) == (step.number, step.sighting.time_s)
        views = [None if camera.view is None else presets[camera.view] for camera in snapshot.cameras]
        assert views == list(step.sighting.views.values())
        seen = {name: cell for name, cell in step.sighting.observations.items() if cell is not None}
        assert (snapshot.seen_at, snapshot.seen, snapshot.present) == (seen, len(seen), 3)
        assert snapshot.targets == ("red", "blue", "green")
        assert snapshot.belief is not None
        assert np.allclose(snapshot.belief.sum(axis=1), 1, atol=1e-5)
        for name, (column, row) in seen.items():
            assert snapshot.belief[snapshot.targets.index(name), 10 * row + column] == 1
        south = snapshot.cameras[0]
        assert south.view is not None
        angle = math.radians(HEADINGS[presets[south.view]])
        assert south.heading == pytest.approx((math.cos(angle), math.sin(angle)), abs=0.01)
    summary = running.watch.summary()
    assert snapshot.percent_obs == summary["percent_obs"]
    assert snapshot.truth_m is not None
    assert np.allclose(list(snapshot.truth_m.values()), running.emulation.truth.positions_m)


@pytest.mark.example
def test_a_snapshot_stays_as_it_is(running: Emulated) -> None:
    ((_, first),) = taken(running, 1)
    assert first.belief is not None
    before = first.belief.copy()
    taken(running, 3)
    assert np.array_equal(first.belief, before)
    assert first.number == 1


@pytest.mark.example
def test_a_dead_camera_has_no_view_and_a_reason(running: Emulated) -> None:
    running.emulation.cameras["south"].faults.drop_share = 1.0
    (_, snapshot) = taken(running, 5)[-1]
    south, *others = snapshot.cameras
    assert (south.view, south.heading, south.state, south.failures) == (None, None, "away", 5)
    assert south.because
    assert [(camera.state, camera.failures) for camera in others] == [("ready", 0), ("ready", 0)]


@pytest.mark.example
def test_a_held_camera_says_so_and_loses_no_view() -> None:
    with emulated_watch(lego(), 3, seed=2, held=lambda: ("north-east",)) as running:
        (_, snapshot) = taken(running, 3)[-1]
    assert (snapshot.cameras[2].state, snapshot.cameras[2].failures) == ("held", 0)
    assert snapshot.cameras[2].view is not None


@pytest.mark.example
def test_without_a_truth_there_is_no_percent_obs_and_nobody_on_the_map(running: Emulated) -> None:
    watch = Watch(running.world, running.controller)
    snapshot = snapshot_of(next(watch.turns()), watch, model(running))
    assert (snapshot.truth_m, snapshot.percent_obs) == (None, None)
    assert snapshot.expected is not None


@pytest.mark.example
def test_strangers_are_called_as_they_are_seen() -> None:
    with emulated_watch(lego(), 2, seed=5, strangers=1) as running:
        surveillance = model(running, targets=2)
        for step in islice(running.watch.turns(), 40):
            snapshot = snapshot_of(step, running.watch, surveillance, lambda: running.emulation.truth)
            if "marker 2" in snapshot.targets:
                break
    assert snapshot.truth_m is not None
    assert list(snapshot.truth_m) == ["red", "blue", "marker 2"]
    assert snapshot.targets == ("red", "blue", "marker 2")
    assert "marker 2" in snapshot.seen_at
    assert snapshot.belief is not None
    assert snapshot.belief.shape == (3, 80)


@pytest.mark.example
def test_marks_in_a_picture_are_called_by_the_targets_that_carry_them(running: Emulated) -> None:
    found = [Located(Detection((10.0, 20.0), 0.1, "marker", n, 1.0, 30.0), (1.0, 1.0), (3, 3)) for n in (1, 40)]
    nobody = Located(Detection((1.0, 2.0), 0.1, "blob", None, 1.0, 5.0), (1.0, 1.0), None)
    sight = Sight(Picture(b"jpeg", 704, 576, Position(0.0, 0.0), 1.5), (*found, nobody))
    step = next(running.watch.turns())
    snapshot = snapshot_of(step, running.watch, model(running), sights={"south": sight})
    picture = snapshot.cameras[0].picture
    assert picture is not None
    assert (picture.jpeg, picture.size, picture.step) == (b"jpeg", (704, 576), 1)
    assert picture.marks == (
        Mark((10.0, 20.0), 30.0, "blue"),
        Mark((10.0, 20.0), 30.0, "marker 40"),
        Mark((1.0, 2.0), 5.0, ""),
    )
    assert snapshot.cameras[1].picture is None
