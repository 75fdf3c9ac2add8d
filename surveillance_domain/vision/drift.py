"""By how much a camera looks beside what it says: from points that it saw elsewhere when it was calibrated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.vision.ground import Ground
from surveillance_domain.vision.points import FloorPoint, residuals

__all__ = ["Drift", "drifted"]

_LEAST_SPREAD_PX = 3.0
_PASSES = 5


@dataclass(frozen=True)
class Drift:
    """What became of a preset's points.

    Attributes
    ----------
    found, of : int
        How many agree on where the camera looks now, and how many there were.
    residuals_m : tuple of float
        Of those that agree: how far from where they lie they are put on the floor.
    pan_deg, tilt_deg : float
        What turn of the camera, in its own numbers, moves them as they have moved.
    """

    found: int
    of: int
    residuals_m: tuple[float, ...]
    pan_deg: float
    tilt_deg: float


def drifted(
    camera: Camera, preset: Preset, ground: Ground, before: Sequence[FloorPoint], now: Sequence[FloorPoint | None]
) -> Drift:
    """How points have moved in the picture of a preset; those that moved unlike the others are left out.

    Least squares for a turn in pan and tilt by the pinhole model (Gauss and Newton's method). A point that was found
    wrongly, or that lies elsewhere now, disagrees with the rest and is dropped.

    Parameters
    ----------
    camera : Camera
    preset : Preset
        At which all points were seen.
    ground : Ground
        The calibration that is examined.
    before, now : sequence of FloorPoint
        One by one; ``None`` for those that were not found again.
    """
    pairs = [(old, new) for old, new in zip(before, now, strict=True) if new is not None]
    if not pairs:
        return Drift(0, len(before), (), 0.0, 0.0)
    old, new = (np.array([one.pixel for one in side], dtype=float) for side in zip(*pairs, strict=True))
    agree, turn = np.ones(len(pairs), dtype=bool), np.zeros(2)
    for _ in range(_PASSES):
        here = _seen(camera, preset, old, turn)
        slopes = np.stack([_seen(camera, preset, old, turn + small) - here for small in np.eye(2)], axis=-1)
        turn = turn + np.linalg.lstsq(slopes[agree].reshape(-1, 2), (new - here)[agree].ravel(), rcond=None)[0]
        agree = _near(np.linalg.norm(_seen(camera, preset, old, turn) - new, axis=1))
    kept = [one for (_, one), good in zip(pairs, agree, strict=True) if good]
    off = tuple(one.metres for one in residuals(kept, {preset.name: ground}))
    return Drift(len(kept), len(before), off, float(turn[0]), float(turn[1]))


def _seen(
    camera: Camera, preset: Preset, pixels: Float[np.ndarray, "points 2"], turn_deg: Float[np.ndarray, "2"]
) -> Float[np.ndarray, "points 2"]:
    """Where what is seen at some pixels of a preset's picture is seen when the camera turns from there."""
    view = pinhole(camera, preset.pan, preset.tilt, preset.zoom)
    turned = pinhole(camera, preset.pan + turn_deg[0], preset.tilt + turn_deg[1], preset.zoom)
    return turned.project(view.position_m + view.rays(pixels))


def _near(off_px: Float[np.ndarray, " points"]) -> Bool[np.ndarray, " points"]:
    """Within three times the median, or within three pixels."""
    near: Bool[np.ndarray, " points"] = off_px <= max(3 * float(np.median(off_px)), _LEAST_SPREAD_PX)
    return near
