"""A seed gives one run: pictures, sightings and choices, whichever of the cameras' threads comes first."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable
from itertools import islice
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cv2")

from surveillance_domain.commands.network import network_of
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.watch import Watch
from surveillance_domain.emulation.rendering import Renderer
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.looks import looks
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.load import load_site

LEGO = load_site("lego")


def told(seed: int, steps: int = 4) -> list[Any]:
    """Digests of all pictures, sightings, choices and times of a run."""
    lines: list[Any] = []
    with network_of(LEGO, 3, emulated=True, seed=seed, virtual=True) as network:
        network.world.start(10.0)
        watch = Watch(network.world, make_controller("pomdp", network.surveillance, Setting()), truth=network.truth)
        for step in islice(watch.turns(), steps):
            entry = watch.entry(step)
            del entry["decision_ms"]
            sights = network.eyes.sights  # type: ignore[attr-defined]
            pictures = {name: hashlib.sha256(sight.picture.jpeg).hexdigest() for name, sight in sights.items()}
            lines.append((entry, pictures))
    return lines


@pytest.mark.end_to_end
def test_one_seed_one_run_even_if_threads_come_in_another_order(monkeypatch: pytest.MonkeyPatch) -> None:
    once = told(7)
    together: Callable[..., Any] = VirtualClock.together

    def hindered(self: Any, pool: Any, tasks: Any, until: Any = None) -> Any:
        """The first camera's thread begins when the others are done."""
        done = threading.Semaphore(0)

        def last(task: Callable[[], Any]) -> Callable[[], Any]:
            def run() -> Any:
                for _ in tasks[1:]:
                    done.acquire(timeout=0.05)
                return task()

            return run

        def other(task: Callable[[], Any]) -> Callable[[], Any]:
            def run() -> Any:
                try:
                    return task()
                finally:
                    done.release()

            return run

        return together(self, pool, [last(tasks[0]), *map(other, tasks[1:])] if tasks else [], until)

    monkeypatch.setattr(VirtualClock, "together", hindered)
    assert told(7) == once
    assert told(8) != once


@pytest.mark.example
def test_noise_is_the_givers_own_whoever_comes_first() -> None:
    view = pinhole(LEGO.cameras[0], 0.0, -40.0, 1.0)
    small = pinhole(LEGO.cameras[0], 0.0, -40.0, 1.0, (352, 288))
    nothing = (np.full((1, 2), np.nan), np.zeros(1))
    taken = []
    for order in ((0, 1), (1, 0)):
        renderer = Renderer(LEGO, looks(LEGO, 1), np.random.default_rng(0))
        luck = [np.random.default_rng(1), np.random.default_rng(2)]
        pictures = {}
        for one in order:
            for number in range(2):
                pictures[one, number] = renderer.picture((view, small)[one], *nothing, luck[one])
        taken.append(pictures)
    for key, picture in taken[0].items():
        np.testing.assert_array_equal(picture, taken[1][key])
    assert not np.array_equal(taken[0][0, 0], taken[0][0, 1])
