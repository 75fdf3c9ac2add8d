"""Watches with faults, run in a process of their own, where no annotation is checked at every call.

``python -m tests.fault_campaign south 200 0 latency "drop+503"`` prints one line of JSON for each watch: one that
nobody disturbs in which the camera is absent, and one for each fault, or faults joined by ``+``, of that camera.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from surveillance_domain.cameras.base import Camera
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.vision.observe import Observed
from surveillance_domain.world.eyes import Eyes, Look
from tests.emulated_cameras import jpeg
from tests.emulated_watch import FAULTS, Emulated, campaign, emulated_watch, lego

__all__ = ["main"]

_TARGETS = 3
_PICTURES = ("truncated picture", "garbled picture")


class Peeking:
    """Drawn detections, but of one camera only where it gives a whole picture."""

    def __init__(self, drawn: Eyes, camera: str) -> None:
        self._drawn, self._camera = drawn, camera

    def look(self, camera: Camera, budget_s: float) -> Look:
        if camera.name == self._camera:
            camera.picture(budget_s)
        return self._drawn.look(camera, budget_s)

    def seen(
        self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]
    ) -> Observed:
        return self._drawn.seen(looks, views, elsewhere)


def watch(camera: str, steps: int, seed: int, faults: tuple[str, ...], absent: bool = False) -> dict[str, Any]:
    """What came of a watch."""
    site = lego(without=camera if absent else None)
    small = jpeg()

    def eyes(emulation: EmulatedSite, drawn: Eyes) -> Eyes:
        if not set(faults) & set(_PICTURES):
            return drawn
        emulation.cameras[camera]._snapshot = lambda size, compression: small
        return Peeking(drawn, camera)

    with emulated_watch(site, _TARGETS, seed, eyes) as running:
        sick = site.cameras[0].name if absent else camera
        chosen = [FAULTS[name] for name in faults]
        return _followed(running, steps, sick, chosen, seed)


def _followed(running: Emulated, steps: int, sick: str, faults: list[Any], seed: int) -> dict[str, Any]:
    seen: list[int] = []
    lost = dict.fromkeys(running.world.reports, 0)
    before, longest_s, unnormalised = running.clock.now(), 0.0, 0.0
    for step in campaign(running, steps, sick, faults, np.random.default_rng(seed)):
        seen.append(step.observed)
        for name, view in step.sighting.views.items():
            lost[name] += view is None
        now = running.clock.now()
        before, longest_s = now, max(longest_s, now - before)
        for array in running.controller.belief.arrays:
            off = np.abs(array.sum(axis=0) - 1).max() if (array >= 0).all() else np.inf
            unnormalised = max(unnormalised, float(off))
    return {"seen": seen, "lost": lost, "longest_s": longest_s, "unnormalised": unnormalised}


def main(words: list[str]) -> None:
    camera, steps, seed, *names = words
    print(json.dumps({"faults": None, **watch(camera, int(steps), int(seed), (), absent=True)}), flush=True)
    for name in names:
        found = watch(camera, int(steps), int(seed), tuple(name.split("+")))
        print(json.dumps({"faults": name, **found}), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
