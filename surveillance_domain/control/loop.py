"""The one control loop, for the simulated world and for a network of cameras."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import count, islice
from time import perf_counter

from surveillance_domain.control.base import Choice, Controller
from surveillance_domain.world.base import Sighting, TrueWorld, World
from surveillance_domain.world.truth import OUTSIDE

__all__ = ["Step", "run_loop", "turns"]


@dataclass(frozen=True)
class Step:
    """One turn of the loop.

    Attributes
    ----------
    number : int
        From 1.
    choice : Choice
    sighting : Sighting
    decision_ms : float
        Time for prediction, choice and conditioning together.
    truly_present : int or None
        How many targets there were on the map, where the world knows the truth.
    """

    number: int
    choice: Choice
    sighting: Sighting
    decision_ms: float
    truly_present: int | None = None

    @property
    def observed(self) -> int:
        """How many targets were seen: M_obs of PercentObs."""
        known = sum(cell is not None for cell in self.sighting.observations.values())
        return known + len(self.sighting.unknown)

    @property
    def beyond(self) -> int:
        """How many of them beyond the views of the model only."""
        return len(self.sighting.beyond)

    @property
    def present(self) -> int:
        """How many targets there were, in truth or else as far as the sighting tells: M_tot."""
        if self.truly_present is not None:
            return self.truly_present
        return len(self.sighting.observations) + len(self.sighting.unknown)


def turns(world: World, controller: Controller) -> Iterator[Step]:
    """Choose, move, observe, learn; for ever, one step each time that one is asked for."""
    for number in count(1):
        started = perf_counter()
        choice = controller.choose()
        chosen = perf_counter()
        world.move(choice.presets)
        sighting = world.observe()
        seen = perf_counter()
        controller.see(sighting)
        spent = (chosen - started) + (perf_counter() - seen)
        present = int((world.truth.cells != OUTSIDE).sum()) if isinstance(world, TrueWorld) else None
        yield Step(number, choice, sighting, 1000 * spent, present)


def run_loop(
    world: World, controller: Controller, steps: int, each: Callable[[Step], None] | None = None
) -> list[Step]:
    """The loop for a number of steps.

    Parameters
    ----------
    each : callable, optional
        Told of every step when it is over.
    """
    record = []
    for step in islice(turns(world, controller), steps):
        record.append(step)
        if each is not None:
            each(step)
    return record
