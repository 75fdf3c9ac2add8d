"""Pictures of targets, or of markers laid on the floor, at places that a test chooses; through a real JPEG."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from surveillance_domain.emulation.rendering import Renderer
from surveillance_domain.model.looks import looks
from surveillance_domain.model.pinhole import Pinhole, pinhole
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.load import load_site
from surveillance_domain.site.sections import Markers
from surveillance_domain.site.site import Site
from surveillance_domain.vision.opencv import decoded

__all__ = ["LAID_M", "jpeg_of", "laid", "pixels_of", "preset_view", "seen_whole", "watched"]

LAID_M = 0.001
"""Height of a marker that lies on the floor, as the renderer draws it."""


def watched(camera: Camera, markers: Markers | None, free: np.ndarray | None = None) -> Site:
    """A site of 4 x 4 cells of half a metre with one camera."""
    site = load_site("lego")
    grid = Grid(np.ones((4, 4), dtype=bool) if free is None else free, 0.5)
    return replace(site, grid=grid, cameras=(camera,), markers=markers)


def laid(site: Site) -> Site:
    """The site with its markers on the floor instead of on robots."""
    assert site.markers is not None
    return replace(site, markers=site.markers.model_copy(update={"height_m": LAID_M}))


def preset_view(camera: Camera, name: str) -> Pinhole:
    """What a camera sees at a preset."""
    (preset,) = [one for one in camera.presets if one.name == name]
    return pinhole(camera, preset.pan, preset.tilt, preset.zoom)


def jpeg_of(
    site: Site,
    view: Pinhole,
    places_m: Sequence[Sequence[float]],
    headings_rad: Sequence[float] | None = None,
    seed: int = 0,
) -> bytes:
    """The JPEG of the first targets of a site at some places."""
    renderer = _renderer(site, len(places_m), seed)
    headings = np.zeros(len(places_m)) if headings_rad is None else np.array(headings_rad, dtype=float)
    return renderer.jpeg(view, np.array(places_m, dtype=float).reshape(-1, 2), headings)


@lru_cache(maxsize=8)
def _renderer(site: Site, targets: int, seed: int) -> Renderer:
    return Renderer(site, looks(site, targets), np.random.default_rng(seed))


def pixels_of(
    site: Site,
    view: Pinhole,
    places_m: Sequence[Sequence[float]],
    headings_rad: Sequence[float] | None = None,
    seed: int = 0,
) -> np.ndarray:
    """The same, decoded again."""
    return decoded(jpeg_of(site, view, places_m, headings_rad, seed))


def seen_whole(view: Pinhole, place_m: np.ndarray, radius_m: float, heights_m: Sequence[float]) -> bool:
    """Whether a body of some radius about a place lies in the picture with five pixels to spare."""
    around = radius_m * np.array([(1, 0), (0.7, 0.7), (0, 1), (-0.7, 0.7), (-1, 0), (-0.7, -0.7), (0, -1), (0.7, -0.7)])
    for height in heights_m:
        pixels = view.project(np.column_stack([place_m + around, np.full(len(around), height)]))
        if not ((pixels >= 5) & (pixels <= np.array([view.width, view.height]) - 6)).all():
            return False
    return True
