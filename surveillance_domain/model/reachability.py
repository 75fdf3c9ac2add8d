"""Slew: which presets a camera reaches from which within one step (model.md, "Slew")."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.camera import Camera

__all__ = ["longest_move_s", "reachable"]

_ROUNDING_S = 1e-9


def reachable(camera: Camera, step_s: float) -> Bool[np.ndarray, "presets presets"]:
    """``reachable[c, a]``: from preset ``c`` the camera has settled in preset ``a`` after ``step_s`` seconds.

    Pan, tilt and zoom move at once, so the slowest of them plus ``settle_s`` counts. An axis whose speed the site
    leaves out takes no time; with all three left out, every preset is reachable. Pan does not turn through its end
    stops, so 350 degrees are 350 degrees. Staying is always possible.
    """
    if all(speed is None for speed in _speeds(camera)):
        return np.ones((len(camera.presets),) * 2, dtype=bool)
    return (_moves_s(camera) <= step_s + _ROUNDING_S) | np.eye(len(camera.presets), dtype=bool)


def longest_move_s(camera: Camera, step_s: float) -> float:
    """Seconds that the longest move takes among those that end within a step, ``settle_s`` included."""
    return float(_moves_s(camera)[reachable(camera, step_s)].max())


def _speeds(camera: Camera) -> tuple[float | None, float | None, float | None]:
    return camera.pan_deg_per_s, camera.tilt_deg_per_s, camera.zoom_per_s


def _moves_s(camera: Camera) -> Float[np.ndarray, "presets presets"]:
    places = np.array([(preset.pan, preset.tilt, preset.zoom) for preset in camera.presets])
    pace = np.array([np.inf if speed is None else speed for speed in _speeds(camera)])
    return (np.abs(places[:, None] - places[None]) / pace).max(axis=2) + camera.settle_s
