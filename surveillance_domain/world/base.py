"""The world as a controller meets it: presets go out, a sighting comes back."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

from surveillance_domain.world.truth import Truth

__all__ = ["Cell", "Sighting", "TrueWorld", "World"]

Cell = tuple[int, int]


@dataclass(frozen=True)
class Sighting:
    """What came back from one step.

    Attributes
    ----------
    observations : dict
        For each target the cell (column, row) at which it was seen, or ``None``: not seen by any camera.
    views : dict
        For each camera the preset whose view it really had; ``None``: none (unavailable, or still moving).
    time_s : float
        When, on the world's clock.
    static : dict
        What static wide-view cameras report, where the site has some; only the controller MSP reads it.
    held : frozenset of str
        Cameras that people have, which will get no commands for now.
    unknown : dict
        What was seen that no target of the model carries, such as ``marker 12``, and the cell at which it was.
    without_identity, out_of_view : int
        Detections that were counted and not used: those that may be any target, and those on no free cell.
    beyond : dict
        Who of those seen, unknown ones included, was seen beyond the view that the model gives the camera, and by which
        camera: pictures show more than the views of the model.
    elsewhere : dict
        For cameras that looked, still, but at no preset of their own, because people have turned them: pan and tilt in
        degrees, and zoom.
    through : dict
        Who was seen by such a camera only, unknown ones included, and by which.
    private : frozenset of str
        Cameras that look into a private area, at no preset of their own: what they show is neither used nor shown.
    """

    observations: Mapping[str, Cell | None]
    views: Mapping[str, str | None]
    time_s: float
    static: Mapping[str, Cell | None] = field(default_factory=dict)
    held: frozenset[str] = frozenset()
    unknown: Mapping[str, Cell] = field(default_factory=dict)
    without_identity: int = 0
    out_of_view: int = 0
    beyond: Mapping[str, str] = field(default_factory=dict)
    elsewhere: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    through: Mapping[str, str] = field(default_factory=dict)
    private: frozenset[str] = frozenset()

    @property
    def looking(self) -> frozenset[str]:
        """Cameras that had a view, at a preset of theirs or elsewhere."""
        return frozenset([*(name for name, view in self.views.items() if view is not None), *self.elsewhere])


@runtime_checkable
class World(Protocol):
    """Something with cameras in it: simulated, or a network of real ones."""

    def move(self, presets: Mapping[str, str]) -> None:
        """Send each camera to a preset; those left out keep theirs."""

    def observe(self) -> Sighting:
        """Let one step pass and report what was seen at its end."""


@runtime_checkable
class TrueWorld(Protocol):
    """A world that knows the truth; no controller but the bounds is shown it."""

    @property
    def truth(self) -> Truth:
        """The targets' true states now."""
