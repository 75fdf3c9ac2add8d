"""A long watch in virtual time, over real HTTP: faults all along, a picture in every hundredth step.

``python -m tests.soak 100000 FOLDER`` prints memory (bytes), open files and threads along the way as lines of JSON. The
record goes to the folder, in files of two megabytes.
"""

from __future__ import annotations

import json
import os
import sys
import threading
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from surveillance_domain.cameras.base import Camera
from surveillance_domain.control.record import RecordWriter
from surveillance_domain.control.watch import Watch
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.vision.observe import Observed
from surveillance_domain.world.eyes import Eyes, Look
from surveillance_domain.world.picture_eyes import PictureEyes
from tests.emulated_watch import FAULTS, campaign, emulated_watch, lego, model_of

__all__ = ["main"]

_TARGETS = 3
_PICTURE_EVERY = 100
_TOLD = 10
_LASTING = ("wrong password", "drift")
"""Faults that keep a camera away for so long that the others would not be met."""
_DRAWN = tuple(name for name in FAULTS if "picture" not in name and name not in _LASTING)


class Alternating:
    """Pictures in every hundredth step, drawn detections in all others."""

    def __init__(self, drawn: Eyes, pictures: Eyes) -> None:
        self._drawn, self._pictures, self._step = drawn, pictures, 0

    @property
    def _now(self) -> Eyes:
        return self._pictures if self._step % _PICTURE_EVERY == 0 else self._drawn

    def look(self, camera: Camera, budget_s: float) -> Look:
        return self._now.look(camera, budget_s)

    def seen(
        self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]
    ) -> Observed:
        found = self._now.seen(looks, views, elsewhere)
        self._step += 1
        return found


def _eyes(emulation: EmulatedSite, drawn: Eyes) -> Eyes:
    return Alternating(drawn, PictureEyes(model_of(emulation.site, _TARGETS)))


def _used() -> dict[str, int]:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    files = len(os.listdir("/proc/self/fd"))
    return {"bytes": pages * os.sysconf("SC_PAGESIZE"), "files": files, "threads": threading.active_count()}


def main(words: list[str]) -> None:
    steps, folder = int(words[0]), Path(words[1])
    with emulated_watch(lego(), _TARGETS, 0, _eyes, strangers=1, wired=True) as running:
        record = RecordWriter(folder, {"site": "lego", "step_s": 1.5}, 7.0, full_bytes=2_000_000)
        running.watch = Watch(running.world, running.controller, record, lambda: running.emulation.truth)
        faults = [FAULTS[name] for name in _DRAWN]
        for step in campaign(running, steps, "south", faults, np.random.default_rng(0)):
            if step.number % max(1, steps // _TOLD) == 0:
                print(json.dumps({"step": step.number, **_used()}), flush=True)
        record.close()
        print(json.dumps(running.watch.summary()), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
