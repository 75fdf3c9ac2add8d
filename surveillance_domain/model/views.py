"""What each camera sees of the floor in each of its presets: ``p_i(l, c)`` of model.md, "Imperfect eyes"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from surveillance_domain.model.line_of_sight import line_of_sight
from surveillance_domain.model.optics import depth_m, in_picture, reach_m, within_depth
from surveillance_domain.model.privacy import privacy_faults
from surveillance_domain.model.privacy_masks import masked_points
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.site import Site

__all__ = ["Views", "build_views", "fields_of_view", "static_views"]


@dataclass(frozen=True, eq=False)
class Views:
    """Detection probabilities of all cameras.

    Attributes
    ----------
    detection : tuple of (presets, cells) float
        ``detection[i][c, l]``: probability that camera ``i`` in preset ``c`` detects a target in free cell ``l``; zero
        where the cell is not in the field of view.
    noise_m : tuple of float
        Standard deviation of the cell that camera ``i`` reports, in metres.
    """

    detection: tuple[Float[np.ndarray, "_presets cells"], ...]
    noise_m: tuple[float, ...]

    def seen(self, presets: Sequence[int | None]) -> Float[np.ndarray, " cells"]:
        """``P(seen | l, C) = 1 - prod_i (1 - p_i(l, c_i))``, one preset of each camera; ``None`` is an empty view."""
        missed = np.ones(self.detection[0].shape[1])
        for camera, preset in zip(self.detection, presets, strict=True):
            if preset is not None:
                missed = missed * (1 - camera[preset])
        return 1 - missed


def build_views(site: Site) -> Views:
    """Every preset's field of view: in the picture, within the depth, no wall between (model.md, "Resolution").

    Cells whose centre lies behind one of the camera's privacy masks are in none of its fields of view.

    Time: free cells in reach times the cells on the way to them; memory: cells times presets.

    Raises
    ------
    SiteError
        Naming every preset that sees no free cell or looks into a private area.
    """
    masks = [fields_of_view(site.grid, camera, camera.presets) for camera in site.cameras]
    faults = [
        _blind(site.grid, camera, preset, f"cameras[{i}].presets[{c}]")
        for i, camera in enumerate(site.cameras)
        for c, preset in enumerate(camera.presets)
        if not masks[i][c].any()
    ]
    faults.extend(privacy_faults(site))
    if faults:
        raise SiteError(str(site.path or f"site {site.name}"), tuple(faults))
    return Views(
        detection=tuple(mask * camera.detection_probability for mask, camera in zip(masks, site.cameras, strict=True)),
        noise_m=tuple(camera.cell_noise_m for camera in site.cameras),
    )


def static_views(site: Site) -> Bool[np.ndarray, "static_cameras cells"]:
    """Which free cells each static camera sees: all that no wall hides from it."""
    seen = [line_of_sight(site.grid, np.array(one.position_m[:2]), site.grid.centres_m) for one in site.static_cameras]
    return np.array(seen, dtype=bool).reshape(len(seen), site.grid.size)


def fields_of_view(grid: Grid, camera: Camera, presets: Sequence[Preset]) -> Bool[np.ndarray, "presets cells"]:
    """Which free cells a camera has in view at some presets: pictured, in its depth, with no wall or mask between."""
    near = _cells_in_reach(grid, camera, presets)
    points = _on_floor(grid.centres_m[near])
    shown = np.array([in_picture(camera, preset, points) & within_depth(camera, preset, points) for preset in presets])
    shown &= ~masked_points(camera, points)
    wanted = np.flatnonzero(shown.any(axis=0))
    clear = line_of_sight(grid, np.array(camera.mount.position_m[:2]), points[wanted, :2])
    views = np.zeros((len(presets), grid.size), dtype=bool)
    views[:, near[wanted]] = shown[:, wanted] & clear
    return views


def _cells_in_reach(grid: Grid, camera: Camera, presets: Sequence[Preset]) -> Int[np.ndarray, " near"]:
    """Numbers of the free cells in the square about the camera that no field of view of the presets can leave."""
    reach = max(reach_m(camera, preset) for preset in presets)
    position = np.array(camera.mount.position_m[:2])
    corners = np.stack([position - reach, position + reach])
    (left, bottom), (right, top) = np.clip(
        (corners - np.asarray(grid.origin_m)) / grid.cell_m, -1, max(grid.columns, grid.rows) + 1
    ).tolist()
    window = grid.number[max(0, int(bottom)) : max(0, int(top) + 1), max(0, int(left)) : max(0, int(right) + 1)]
    return window[window >= 0]


def _on_floor(points_m: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "points 3"]:
    return np.pad(points_m, ((0, 0), (0, 1)))


def _blind(grid: Grid, camera: Camera, preset: Preset, where: str) -> Fault:
    """Why a preset sees nothing."""
    points = _on_floor(grid.centres_m)
    pictured = in_picture(camera, preset, points)
    deep = pictured & within_depth(camera, preset, points)
    if not pictured.any():
        expected = "a pan, tilt and zoom whose picture holds the centre of a free cell"
    elif not deep.any():
        expected = f"a free cell within the depth of {depth_m(camera, preset):.3g} m (max_depth_m, required_px_per_m)"
    else:
        total, hidden = int(deep.sum()), int(masked_points(camera, points[deep]).sum())
        others = ", walls the others" if hidden < total else ""
        hiding = f"privacy_masks hide {hidden} of {total}" if hidden else f"walls hide all {total}"
        expected = f"a clear view: {hiding} free cells in its picture{others if hidden else ''}"
    return Fault(where, f'preset "{preset.name}" of camera "{camera.name}" that sees no free cell', expected)
