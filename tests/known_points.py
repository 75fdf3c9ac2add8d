"""Points of the floor as a camera of known mount would show them, with errors on demand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.load import load_site
from surveillance_domain.vision.points import FloorPoint
from tests.pictured_targets import preset_view

__all__ = ["CORNERS", "lego_camera", "points_of"]

CORNERS = ((0.9, 1.0), (2.1, 1.0), (1.0, 1.9), (2.0, 1.9), (1.5, 1.4), (1.3, 1.2))
"""On the lego site, in view of the southern camera in the middle."""


def lego_camera(**mount: object) -> Camera:
    """The southern camera of the lego site, with another mount."""
    camera = load_site("lego").cameras[0]
    return camera.model_copy(update={"mount": camera.mount.model_copy(update=mount)})


def points_of(
    camera: Camera,
    preset: str,
    places_m: Sequence[tuple[float, float]] = CORNERS,
    height_m: float = 0.0,
    noise_px: float = 0.0,
    seed: int = 0,
) -> list[FloorPoint]:
    """Where a preset shows some places; all must be in the picture."""
    view = preset_view(camera, preset)
    pixels = view.project(np.array([(x, y, height_m) for x, y in places_m]))
    assert ((pixels >= 0) & (pixels < (view.width, view.height))).all()
    pixels += noise_px * np.random.default_rng(seed).standard_normal(pixels.shape)
    return [
        FloorPoint(f"{preset} {number}", preset, (float(u), float(v)), place, height_m)
        for number, (place, (u, v)) in enumerate(zip(places_m, pixels, strict=True))
    ]
