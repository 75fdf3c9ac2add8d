"""The picture of ``surveillance coverage``: map, obstacles, every preset's field of view."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from surveillance_domain.model.coverage import best_joint_coverage
from surveillance_domain.model.optics import orientation
from surveillance_domain.model.views import Views
from surveillance_domain.pictures.floor import draw_camera, draw_cells, draw_floor, extent_m
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, styled
from surveillance_domain.site.camera import Camera, Preset
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_coverage"]

_WIDTH_IN = 7.5
_MOST_HEIGHT_IN = 40.0


@styled
def draw_coverage(site: Site, views: Views) -> Figure:
    """One panel for each preset, a row for each camera, and above them the joint preset that sees most of the floor.

    The title says which share of the free floor that joint preset sees, and which share any preset sees at all.
    """
    left, right, bottom, top = extent_m(site.grid)
    margin_m = 0.03 * max(right - left, top - bottom)
    best, how = best_joint_coverage(views)
    rows, columns = len(site.cameras), max(len(camera.presets) for camera in site.cameras)
    shape = (top - bottom + 2 * margin_m) / (right - left + 2 * margin_m)
    heights = [min(_WIDTH_IN * shape, 4.5), *[_WIDTH_IN / columns * shape + 0.3] * rows]
    figure = new_figure(_WIDTH_IN, min(sum(heights) + 0.9, _MOST_HEIGHT_IN))
    panels = figure.add_gridspec(rows + 1, columns, height_ratios=heights)
    overview = figure.add_subplot(panels[0, :])
    draw_floor(overview, site.grid, margin_m)
    for index, (camera, preset) in enumerate(zip(site.cameras, best, strict=True)):
        colour = CAMERA_COLOURS[index % len(CAMERA_COLOURS)]
        draw_cells(overview, site.grid, views.detection[index][preset] > 0, colour)
        _draw_axis(overview, camera, camera.presets[preset], colour, 2 * margin_m)
    named = [f"{camera.name} {camera.presets[preset].name}" for camera, preset in zip(site.cameras, best, strict=True)]
    overview.set_title(fill(", ".join(named), int(13 * _WIDTH_IN)))
    for index, camera in enumerate(site.cameras):
        colour = CAMERA_COLOURS[index % len(CAMERA_COLOURS)]
        for number, preset_ in enumerate(camera.presets):
            panel = figure.add_subplot(panels[index + 1, number])
            seen = views.detection[index][number] > 0
            draw_floor(panel, site.grid, margin_m)
            draw_cells(panel, site.grid, seen, colour)
            _draw_axis(panel, camera, preset_, colour, 2 * margin_m)
            panel.set_title(fill(f"{camera.name}: {preset_.name} ({np.mean(seen):.0%})", int(13 * _WIDTH_IN / columns)))
    joint = np.mean(views.seen(best) > 0)
    union = np.mean(np.any([np.any(one > 0, axis=0) for one in views.detection], axis=0))
    figure.suptitle(f"{site.name}: {how} joint preset sees {joint:.0%} of the floor, all presets see {union:.0%}")
    return figure


def _draw_axis(axes: Axes, camera: Camera, preset: Preset, colour: str, length_m: float) -> None:
    """The camera and the direction in which it looks."""
    draw_camera(axes, camera, colour)
    x, y, _ = camera.mount.position_m
    forward = orientation(camera.mount, preset.pan, preset.tilt)[:2, 0]
    norm = float(np.hypot(*forward))
    if norm > 1e-9:
        tip = np.array([x, y]) + forward / norm * length_m
        axes.annotate(
            "",
            xy=(float(tip[0]), float(tip[1])),
            xytext=(x, y),
            zorder=6,
            annotation_clip=False,
            arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
        )
