"""Small sites whose cameras see exactly the cells that a test says, whatever optics would make of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any
from unittest.mock import patch

import numpy as np

from surveillance_domain.model.build import Surveillance, surveillance_model
from surveillance_domain.model.views import Views
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import StaticCamera
from surveillance_domain.site.site import Site

__all__ = ["altered", "hand_made"]

Seen = Mapping[str, Mapping[str, Iterable[int]]]


def altered(
    name: str, *, cameras: Mapping[str, Mapping[str, Any]] | None = None, step_s: float | None = None, **targets: Any
) -> Site:
    """A built-in site with other target motion, or other fields of cameras (by name; ``"*"``: all)."""
    site = load_site(name)
    changes = cameras or {}
    changed = [c.model_copy(update={**changes.get("*", {}), **changes.get(c.name, {})}) for c in site.cameras]
    control = site.control if step_s is None else site.control.model_copy(update={"step_s": step_s})
    return replace(site, targets=site.targets.model_copy(update=targets), cameras=tuple(changed), control=control)


def hand_made(
    rows: list[str],
    seen: Seen,
    targets: int = 1,
    *,
    detection: float | Mapping[str, float] = 1.0,
    noise_m: Mapping[str, float] | None = None,
    static: Iterable[StaticCamera] = (),
    pan_deg_per_s: float | None = None,
    **motion: Any,
) -> Surveillance:
    """A model of a drawn map; ``seen[camera][preset]`` are the numbers of the free cells in view.

    Presets lie 10 degrees of pan apart, in order. Motion: four directions and one cell a step, unless told otherwise.
    """
    noise = noise_m or {}
    base = load_site("tiny")
    cameras, tables = [], []
    grid = Grid.from_rows(rows, 1.0)
    for camera, views in seen.items():
        probability = detection if isinstance(detection, float) else detection[camera]
        presets = [
            {"name": preset, "pan": 10.0 * number, "tilt": -45.0, "zoom": 1} for number, preset in enumerate(views)
        ]
        own = {"name": camera, "presets": presets, "pan_deg_per_s": pan_deg_per_s, "cell_noise_m": noise.get(camera, 0)}
        cameras.append(Camera.model_validate({**base.cameras[0].model_dump(), **own}))
        tables.append(np.zeros((len(presets), grid.size)))
        for table, cells in zip(tables[-1], views.values(), strict=True):
            table[list(cells)] = probability
    moving = {"directions": 4, "speeds_mps": (1.0,), "sigma_direction_deg": 45.0, "sigma_speed_mps": 0.0, **motion}
    site = replace(
        base,
        name="drawn",
        grid=grid,
        cameras=tuple(cameras),
        static_cameras=tuple(static),
        targets=base.targets.model_copy(update=moving),
    )
    views = Views(tuple(tables), tuple(camera.cell_noise_m for camera in cameras))
    with patch("surveillance_domain.model.build.build_views", lambda _: views):
        return surveillance_model(site, targets)
