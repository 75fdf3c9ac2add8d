"""Cameras that look into a private area."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.line_of_sight import line_of_sight
from surveillance_domain.model.optics import in_picture
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.site import Site

__all__ = ["looks_into_private", "privacy_faults"]

_LEAST_SAMPLES_A_SIDE = 12
_MOST_SAMPLES_A_SIDE = 400


def privacy_faults(site: Site) -> Iterator[Fault]:
    """One fault for each preset whose picture shows a part of a private area's floor.

    The depth of a field of view is no excuse: what lies beyond it is shown too, only smaller. Walls are. The area is
    sampled a quarter of a cell apart, closer in small areas, with at most 400 points a side.
    """
    for number, area in enumerate(site.privacy):
        points = _samples(np.array(area.polygon_m), site.grid.cell_m)
        for i, camera in enumerate(site.cameras):
            for c in _looking_at(site, camera, camera.presets, points):
                preset = camera.presets[c]
                found = f'preset "{preset.name}" of camera "{camera.name}" that looks into privacy[{number}]'
                yield Fault(f"cameras[{i}].presets[{c}]", found, "a preset that does not, or none")


def looks_into_private(site: Site, camera: Camera, preset: Preset) -> bool:
    """Whether a camera's picture at a preset shows a part of a private area's floor."""
    areas = (_samples(np.array(area.polygon_m), site.grid.cell_m) for area in site.privacy)
    return any(_looking_at(site, camera, [preset], points) for points in areas)


def _looking_at(
    site: Site, camera: Camera, presets: Sequence[Preset], points: Float[np.ndarray, "points 2"]
) -> list[int]:
    """Numbers of the presets whose picture shows one of some points on the floor, with no wall between."""
    shown = [in_picture(camera, preset, np.pad(points, ((0, 0), (0, 1)))) for preset in presets]
    wanted = np.flatnonzero(np.any(shown, axis=0))
    clear = line_of_sight(site.grid, np.array(camera.mount.position_m[:2]), points[wanted])
    return [c for c, picture in enumerate(shown) if np.any(picture[wanted] & clear)]


def _samples(polygon: Float[np.ndarray, "corners 2"], cell_m: float) -> Float[np.ndarray, "points 2"]:
    """Points inside a polygon, in metres."""
    low, high = polygon.min(axis=0), polygon.max(axis=0)
    counts = np.clip((high - low) / (cell_m / 4), _LEAST_SAMPLES_A_SIDE, _MOST_SAMPLES_A_SIDE).astype(int)
    x, y = (low[axis] + (np.arange(counts[axis]) + 0.5) / counts[axis] * (high - low)[axis] for axis in (0, 1))
    points = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    return np.concatenate([points[_inside(polygon, points)], _just_inside(polygon)])


def _inside(polygon: Float[np.ndarray, "corners 2"], points: Float[np.ndarray, "points 2"]) -> np.ndarray:
    """Even-odd rule: a point is inside if a ray to the right crosses an odd number of edges."""
    x, y = points.T
    inside = np.zeros(len(points), dtype=bool)
    for (ax, ay), (bx, by) in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        if ay != by:
            crossing = ax + (y - ay) / (by - ay) * (bx - ax)
            inside ^= ((ay > y) != (by > y)) & (x < crossing)
    return inside


def _just_inside(polygon: Float[np.ndarray, "corners 2"]) -> Float[np.ndarray, "points 2"]:
    """Corners and edges' middles, drawn a thousandth towards the centre of the corners where that lies inside."""
    rim = np.concatenate([polygon, (polygon + np.roll(polygon, -1, axis=0)) / 2])
    drawn = rim + (polygon.mean(axis=0) - rim) * 1e-3
    return drawn[_inside(polygon, drawn)]
