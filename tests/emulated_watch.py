"""A watch over emulated cameras in virtual time, with faults that come and go."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.control.factory import Setting, make_controller
from surveillance_domain.control.loop import Step
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.watch import Watch
from surveillance_domain.emulation.faults import Faults
from surveillance_domain.emulation.site import PASSWORD, EmulatedSite
from surveillance_domain.emulation.truth_eyes import TruthEyes
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site
from surveillance_domain.world.eyes import Eyes
from surveillance_domain.world.network import NetworkWorld
from tests.direct_session import direct_session

__all__ = ["FAULTS", "Emulated", "campaign", "emulated_watch", "lego", "model_of"]

Fault = Callable[[Faults, bool], None]


def _set(name: str, value: object) -> Fault:
    return lambda faults, on: setattr(faults, name, value if on else getattr(Faults(), name))


def _reboot(faults: Faults, on: bool) -> None:
    faults.reboot_in_move = faults.reboot_in_move or on


FAULTS: dict[str, Fault] = {
    "latency": _set("latency_s", 2.0),
    "a little latency": _set("latency_s", 0.25),
    "drop": _set("drop_share", 0.7),
    "503": _set("unavailable_share", 0.7),
    "wrong password": _set("wrong_password", True),
    "reboot in mid-move": _reboot,
    "frozen position": _set("frozen", True),
    "truncated picture": _set("truncated_picture", True),
    "garbled picture": _set("garbled_picture", True),
    "drift": _set("pan_drift_deg_per_s", 0.5),
}


def lego(without: str | None = None, **operation: float) -> Site:
    """The paper's real experiment, or what is left of it without one camera."""
    site = load_site("lego")
    kept = tuple(camera for camera in site.cameras if camera.name != without)
    return replace(site, cameras=kept, operation=site.operation.model_copy(update=operation))


@dataclass
class Emulated:
    """All that is at work."""

    site: Site
    clock: VirtualClock
    emulation: EmulatedSite
    world: NetworkWorld
    watch: Watch

    @property
    def controller(self) -> PomdpController:
        assert isinstance(self.watch.controller, PomdpController)
        return self.watch.controller


@contextmanager
def emulated_watch(
    site: Site,
    targets: int,
    seed: int,
    eyes: Callable[[EmulatedSite, Eyes], Eyes] | None = None,
    held: Callable[[], Sequence[str]] = tuple,
    moves: bool = True,
    strangers: int = 0,
    wired: bool = False,
) -> Iterator[Emulated]:
    """Cameras, world and watch, got to know and ready; ``grid`` truth, so that the model is the true one.

    Unless they are wired, drivers ask the emulated cameras straight.
    """
    clock = VirtualClock()
    for_truth, for_eyes, for_retries = np.random.default_rng(seed).spawn(3)
    with EmulatedSite(site, targets + strangers, clock, for_truth, truth="grid") as emulation:
        surveillance = replace(model_of(site, targets), site=emulation.site)
        drawn = TruthEyes(surveillance, emulation, for_eyes)
        chosen = drawn if eyes is None else eyes(emulation, drawn)
        cameras = emulation.open_cameras(for_retries) if wired else _unwired(emulation, clock, for_retries)
        world = NetworkWorld(surveillance.site, cameras, chosen, clock, held, moves)
        try:
            assert world.start(10.0) == {}
            controller = make_controller("pomdp", surveillance, Setting(open_roster=True))
            yield Emulated(site, clock, emulation, world, Watch(world, controller, truth=lambda: emulation.truth))
        finally:
            world.close()


_MODELS: dict[tuple[str, tuple[str, ...], int], Surveillance] = {}


def model_of(site: Site, targets: int) -> Surveillance:
    """The same for all runs: addresses and people's habits do not enter into it."""
    key = site.digest, tuple(camera.name for camera in site.cameras), targets
    if key not in _MODELS:
        _MODELS[key] = surveillance_model(site, targets)
    return _MODELS[key]


def _unwired(emulation: EmulatedSite, clock: VirtualClock, rng: np.random.Generator) -> list[VapixCamera]:
    described = emulation.site.cameras
    return [
        open_camera(one, clock, luck, session=direct_session(emulation.cameras[one.name]), password=PASSWORD)
        for one, luck in zip(described, rng.spawn(len(described)), strict=True)
    ]


def campaign(
    running: Emulated, steps: int, camera: str, faults: Sequence[Fault], rng: np.random.Generator
) -> Iterator[Step]:
    """Steps of a watch, in which each fault of one camera comes and goes at random times: 10 steps, on average."""
    state = [False] * len(faults)
    left = [int(rng.integers(2, 15)) for _ in faults]
    for step in running.watch.turns():
        yield step
        if step.number >= steps:
            return
        for number, fault in enumerate(faults):
            left[number] -= 1
            if left[number] <= 0:
                state[number] = not state[number]
                left[number] = math.ceil(rng.exponential(10.0))
                fault(running.emulation.cameras[camera].faults, state[number])
