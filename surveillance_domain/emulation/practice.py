"""An outage to practise on: planned faults of emulated cameras, begun and ended as time passes."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.emulation.camera import EmulatedCamera
from surveillance_domain.emulation.fault_plan import GUARD_TOUR, JOYSTICK, REBOOT, PlannedFault
from surveillance_domain.emulation.faults import Faults
from surveillance_domain.emulation.site import EmulatedSite
from surveillance_domain.site.camera import Preset

__all__ = ["Practice", "practised"]

_TICK_S = 0.1


class Practice:
    """Makes planned faults happen.

    Parameters
    ----------
    emulated : EmulatedSite
    plan : sequence of PlannedFault
    """

    def __init__(self, emulated: EmulatedSite, plan: Sequence[PlannedFault]) -> None:
        presets = {camera.name: camera.presets for camera in emulated.site.cameras}
        in_turn = sorted(plan, key=lambda one: one.begins_s)
        self._waiting = [_Fault(one, emulated.cameras[one.camera], presets[one.camera]) for one in in_turn]
        self._present: list[_Fault] = []

    def advance(self, passed_s: float) -> list[str]:
        """What is due by now happens; for each fault that begins or ends what to tell people.

        Parameters
        ----------
        passed_s : float
            Seconds since the start.
        """
        told = []
        for fault in [one for one in self._present if one.planned.ends_s <= passed_s]:
            self._present.remove(fault)
            fault.go_on(fault.planned.ends_s)
            fault.end()
            told += [] if fault.at_once else [f"{fault.planned.ends_s:g} s: {fault.planned} ends"]
        for fault in [one for one in self._waiting if one.planned.begins_s <= passed_s]:
            self._waiting.remove(fault)
            self._present.append(fault)
            fault.begin()
            told.append(f"{fault.planned.begins_s:g} s: {fault.planned}{'' if fault.at_once else ' begins'}")
        for fault in self._present:
            fault.go_on(min(passed_s, fault.planned.ends_s))
        return told


@contextmanager
def practised(practice: Practice, clock: Clock, tell: Callable[[str], None]) -> Iterator[None]:
    """Faults come and go beside what is done here, on a wall clock; each is told of."""
    over, start = threading.Event(), clock.now()

    def watch() -> None:
        while not over.is_set():
            for one in practice.advance(clock.now() - start):
                tell(one)
            over.wait(_TICK_S)

    thread = threading.Thread(target=watch, daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


class _Fault:
    """One planned fault of one camera, and how far it has come."""

    def __init__(self, planned: PlannedFault, camera: EmulatedCamera, presets: Sequence[Preset]) -> None:
        self.planned, self._camera, self._presets = planned, camera, presets
        self._done_s = planned.begins_s
        self._visited = 0

    @property
    def at_once(self) -> bool:
        """Whether it ends where it begins."""
        return self.planned.kind == REBOOT

    def begin(self) -> None:
        if self.planned.kind == REBOOT:
            self._camera.reboot()
        elif hasattr(self._camera.faults, self.planned.kind):
            value = self.planned.value
            setattr(self._camera.faults, self.planned.kind, True if value is None else value)

    def go_on(self, passed_s: float) -> None:
        """People's moves, up to now; a camera that reboots takes none."""
        if self.planned.kind == JOYSTICK:
            away_deg = (self.planned.value or 0.0) * (passed_s - self._done_s)
            self._done_s = passed_s
            if away_deg and self._camera.motors.awake():
                self._camera.motors.command({"rpan": repr(away_deg)})
        elif self.planned.kind == GUARD_TOUR:
            while self._done_s <= passed_s and self._done_s < self.planned.ends_s:
                self._visited += 1
                preset = self._presets[self._visited % len(self._presets)]
                if self._camera.motors.awake():
                    place = {axis: repr(getattr(preset, axis)) for axis in ("pan", "tilt", "zoom")}
                    self._camera.motors.command(place)
                self._done_s += self.planned.value or _TICK_S

    def end(self) -> None:
        if hasattr(self._camera.faults, self.planned.kind):
            setattr(self._camera.faults, self.planned.kind, getattr(Faults(), self.planned.kind))
