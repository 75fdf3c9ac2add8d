"""What the page knows of one step: a small record that nothing changes any more, so that threads may share it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from surveillance_domain.world.base import Cell

__all__ = ["CameraSnapshot", "Mark", "PictureSnapshot", "Snapshot"]


@dataclass(frozen=True)
class Mark:
    """A detection in a picture.

    Attributes
    ----------
    pixel : (float, float)
        To the right, and down.
    size_px : float
    label : str
        Who it is; empty where the picture does not tell.
    """

    pixel: tuple[float, float]
    size_px: float
    label: str


@dataclass(frozen=True)
class PictureSnapshot:
    """A camera's picture and what was found in it.

    Attributes
    ----------
    jpeg : bytes
    size : (int, int)
        Width and height in pixels.
    step : int
        When it was taken.
    marks : tuple of Mark
    """

    jpeg: bytes
    size: tuple[int, int]
    step: int
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class CameraSnapshot:
    """How a camera is.

    Attributes
    ----------
    name : str
    view : int or None
        Number of the preset that it really looked at; ``None``: it had no view.
    heading : (float, float) or None
        Unit vector on the floor of where it looked, as read back; ``None``: not known, or straight down.
    state : str
        Such as ``ready``, ``away``, ``held``.
    failures : int
        Steps without a view so far, though nobody else had it.
    because : str
        What went wrong with it, in this step or when it last lost its view; empty if nothing did.
    picture : PictureSnapshot or None
        Of this step.
    place : (float, float, float) or None
        Pan and tilt in degrees, and zoom, where it looked at no preset of its own and was listened to all the same.
    private : bool
        Whether it looks into a private area, and is therefore neither listened to nor shown.
    """

    name: str
    view: int | None
    heading: tuple[float, float] | None
    state: str
    failures: int
    because: str
    picture: PictureSnapshot | None
    place: tuple[float, float, float] | None = None
    private: bool = False

    @property
    def has_view(self) -> bool:
        """Whether it was listened to."""
        return self.view is not None or self.place is not None


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One step, as the page shows it.

    Attributes
    ----------
    number : int
        Of the step, from 1.
    time_s : float
        On the world's clock, since the start.
    cameras : tuple of CameraSnapshot
        In the site's order.
    targets : tuple of str
        Those that the controller knows of now.
    belief : (targets, cells) float or None
        Probability of each free cell, after the sighting; less than one together where a target may be off the map.
        ``None`` for controllers without a belief.
    seen_at : dict
        Where targets were seen; those that were not are left out.
    beyond : dict
        Of those, who was seen beyond the view that the model gives the camera, and by which camera.
    seen, present : int
        How many were, and how many there were as far as the sighting tells.
    truth_m : dict or None
        Where the targets really are, x and y in metres, where there is a truth.
    percent_obs : float or None
        So far, in percent; ``None`` where there is no truth.
    expected : float or None
        Targets that the choice of this step expected to be seen.
    restarts : int
        Beliefs started anew so far.
    decision_ms : float
    """

    number: int
    time_s: float
    cameras: tuple[CameraSnapshot, ...]
    targets: tuple[str, ...]
    belief: Float32[np.ndarray, "targets cells"] | None
    seen_at: Mapping[str, Cell]
    beyond: Mapping[str, str]
    seen: int
    present: int
    truth_m: Mapping[str, tuple[float, float]] | None
    percent_obs: float | None
    expected: float | None
    restarts: int
    decision_ms: float
