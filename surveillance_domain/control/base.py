"""What a controller is: it chooses presets, and it is told what came of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from surveillance_domain.world.base import Sighting

__all__ = ["Choice", "Controller"]


@dataclass(frozen=True)
class Choice:
    """Presets for the next step.

    Attributes
    ----------
    presets : dict
        Camera name to preset name.
    value, upper_bound : float or None
        Expected number of targets observed, and what no choice can pass; ``None`` for controllers that do not reckon.
    method : str
    """

    presets: Mapping[str, str]
    value: float | None = None
    upper_bound: float | None = None
    method: str = ""


@runtime_checkable
class Controller(Protocol):
    """One of the paper's methods, or a bound."""

    @property
    def restarts(self) -> int:
        """How many beliefs had to be started anew because the model called the sighting impossible."""

    def choose(self) -> Choice:
        """Presets for the next step, among those that each camera reaches."""

    def see(self, sighting: Sighting) -> None:
        """Learn what the step brought."""
