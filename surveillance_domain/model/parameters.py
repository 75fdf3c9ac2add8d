"""How targets move, in numbers: what a site file says under ``[targets]`` and ``control.step_s``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

__all__ = ["DoorParameters", "MotionParameters", "Walls"]

Walls = Literal["reject", "reflect", "stay"]


@dataclass(frozen=True)
class DoorParameters:
    """Where targets come and go.

    Attributes
    ----------
    cells : tuple of (column, row)
        Free cells.
    rate_per_s : float
        How often a target that is outside enters here, a second.
    """

    cells: tuple[tuple[int, int], ...]
    rate_per_s: float


@dataclass(frozen=True)
class MotionParameters:
    """The numbers of the velocity-direction motion model, eq:targettransmodel.

    Attributes
    ----------
    directions : int
        How many directions; direction j is centred at j * 360 / directions degrees, counter-clockwise from +x.
    speeds_mps : tuple of float
        The set of speeds in metres a second, distinct, in any order; 0 is a speed.
    sigma_direction_deg : float
        Standard deviation of the change of direction in one step, in degrees; 0: the direction never changes.
    sigma_speed_mps : float
        Standard deviation of the change of speed in one step, in metres a second; 0: the speed never changes.
    walls : {"reject", "reflect", "stay"}
        What becomes of a move that a wall or the map's edge forbids.
    step_s : float
        Length of one step in seconds.
    doors : tuple of DoorParameters
        Where targets come and go; without doors their number is constant.

    Raises
    ------
    ValueError
        Naming every field that is wrong, with what was found and what would be right.
    """

    directions: int
    speeds_mps: tuple[float, ...]
    sigma_direction_deg: float
    sigma_speed_mps: float
    walls: Walls
    step_s: float
    doors: tuple[DoorParameters, ...] = ()

    def __post_init__(self) -> None:
        faults = []
        if self.directions < 1:
            faults.append(f"directions is {self.directions}, must be at least 1")
        if not self.speeds_mps:
            faults.append("speeds_mps is empty, must hold at least one speed")
        if not all(math.isfinite(speed) and speed >= 0 for speed in self.speeds_mps):
            faults.append(f"speeds_mps is {self.speeds_mps}, every speed must be finite and not negative")
        if len(set(self.speeds_mps)) < len(self.speeds_mps):
            faults.append(f"speeds_mps is {self.speeds_mps}, no speed may stand in it twice")
        for name in ("sigma_direction_deg", "sigma_speed_mps"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0):
                faults.append(f"{name} is {value}, must be finite and not negative")
        if self.walls not in get_args(Walls):
            faults.append(f"walls is {self.walls!r}, must be one of {', '.join(get_args(Walls))}")
        if not (math.isfinite(self.step_s) and self.step_s > 0):
            faults.append(f"step_s is {self.step_s}, must be finite and positive")
        for number, door in enumerate(self.doors):
            if not door.cells or not (math.isfinite(door.rate_per_s) and door.rate_per_s >= 0):
                faults.append(
                    f"doors[{number}] is {door}, must have a cell, and a rate that is finite and not negative"
                )
        if faults:
            raise ValueError("motion parameters: " + "; ".join(faults))
