"""Slew: which presets a camera reaches from which within one step (model.md, "Slew")."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool

from surveillance_domain.site.camera import Camera

__all__ = ["reachable"]

_ROUNDING_S = 1e-9


def reachable(camera: Camera, step_s: float) -> Bool[np.ndarray, "presets presets"]:
    """``reachable[c, a]``: from preset ``c`` the camera has settled in preset ``a`` after ``step_s`` seconds.

    Pan, tilt and zoom move at once, so the slowest of them plus ``settle_s`` counts. An axis whose speed the site
    leaves out takes no time; with all three left out, every preset is reachable. Pan does not turn through its end
    stops, so 350 degrees are 350 degrees. Staying is always possible.
    """
    speeds = (camera.pan_deg_per_s, camera.tilt_deg_per_s, camera.zoom_per_s)
    count = len(camera.presets)
    if all(speed is None for speed in speeds):
        return np.ones((count, count), dtype=bool)
    places = np.array([(preset.pan, preset.tilt, preset.zoom) for preset in camera.presets])
    pace = np.array([np.inf if speed is None else speed for speed in speeds])
    travel_s = (np.abs(places[:, None] - places[None]) / pace).max(axis=2)
    return (travel_s + camera.settle_s <= step_s + _ROUNDING_S) | np.eye(count, dtype=bool)
