"""One step of a run: map, fields of view, belief as a heat map, and where the targets really are."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.model.views import Views
from surveillance_domain.pictures.floor import draw_camera, draw_floor, extent_m, outline_m
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, WALL, new_figure, styled
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.collections import LineCollection, PathCollection
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage
    from matplotlib.text import Text

__all__ = ["HEAT_COLOURS", "Frame", "Scene", "draw_scene"]

HEAT_COLOURS = ("#ffffff", "#cbb8e0", "#8a63b5", "#3f1d6b")
"""White to dark violet: no camera has this colour, and it darkens evenly in a print without colours."""

_WIDTH_IN = 7.5
_TINT = 0.12
_BAR_TICKS = {0: "0", 0.01: ".01", 0.05: ".05", 0.1: ".1", 0.2: ".2", 0.4: ".4", 0.6: ".6", 0.8: ".8", 1.0: "1+"}


@dataclass(frozen=True, eq=False)
class Frame:
    """What is to be seen after one step.

    Attributes
    ----------
    number : int
        Of the step, from 1.
    positions_m : (targets, 2) float
        Where the targets really are; nan for those that are not on the map.
    observed : (targets,) bool
        Whether some camera saw them.
    presets : tuple of int or None
        Which view each camera had; ``None``: none.
    expected : (cells,) float or None
        Expected number of targets in each free cell, after the sighting; ``None`` for controllers without a belief.
    percent_obs : float
        So far; nan while there were no targets.
    elsewhere : dict
        By a camera's number the free cells that it saw, if it looked at no preset of its own.
    """

    number: int
    positions_m: Float[np.ndarray, "targets 2"]
    observed: Bool[np.ndarray, " targets"]
    presets: tuple[int | None, ...]
    expected: Float[np.ndarray, " cells"] | None
    percent_obs: float
    elsewhere: Mapping[int, Bool[np.ndarray, " cells"]] = field(default_factory=dict)

    def seen(self, views: Views, camera: int) -> Bool[np.ndarray, " cells"] | None:
        """Free cells that a camera had in view, by its number; ``None``: it had no view."""
        preset = self.presets[camera]
        return self.elsewhere.get(camera) if preset is None else views.detection[camera][preset] > 0


@dataclass(frozen=True, eq=False)
class Scene:
    """A figure whose moving parts can be set to one frame after the other."""

    figure: Figure
    axes: Axes
    site: Site
    views: Views
    heading: str
    floor: AxesImage
    outlines: tuple[LineCollection, ...]
    frame_and_cameras: tuple[Artist, ...]
    dots: PathCollection
    title: Text

    @property
    def moving(self) -> tuple[Artist, ...]:
        """What changes from frame to frame or lies above it, from the ground up."""
        return (self.floor, *self.outlines, *self.frame_and_cameras, self.dots, self.title)

    def show(self, frame: Frame) -> None:
        """Set everything to a frame."""
        grid = self.site.grid
        self.floor.set_data(_ground(self.site, self.views, frame))
        for number, lines in enumerate(self.outlines):
            member = np.zeros(grid.free.shape, dtype=bool)
            seen = frame.seen(self.views, number)
            if seen is not None:
                member[grid.free] = seen
            lines.set_segments(list(outline_m(grid, member)))
        present = np.isfinite(frame.positions_m).all(axis=1)
        observed = frame.observed[present]
        self.dots.set_offsets(frame.positions_m[present])
        self.dots.set_facecolor([INK if seen else "#ffffff" for seen in observed])
        self.dots.set_edgecolor(["#ffffff" if seen else INK for seen in observed])
        so_far = "" if np.isnan(frame.percent_obs) else f", PercentObs so far {frame.percent_obs:.1f} %"
        self.title.set_text(
            f"{self.heading}\nstep {frame.number}: {observed.sum()} of {len(observed)} observed{so_far}"
        )


def draw_scene(site: Site, views: Views, frame: Frame, heading: str) -> Scene:
    """A figure of one step; a belief gets a colour bar."""
    made: list[Scene] = []

    @styled
    def draw() -> Figure:
        made.append(_drawn(site, views, frame, heading))
        return made[0].figure

    draw()
    return made[0]


def _drawn(site: Site, views: Views, frame: Frame, heading: str) -> Scene:
    from matplotlib.collections import LineCollection

    left, right, bottom, top = extent_m(site.grid)
    margin_m = 0.03 * max(right - left, top - bottom)
    shape = (top - bottom + 2 * margin_m) / (right - left + 2 * margin_m)
    figure = new_figure(_WIDTH_IN, min(_WIDTH_IN * shape, 8.0) + (0.8 if frame.expected is None else 1.3))
    axes = figure.add_subplot()
    draw_floor(axes, site.grid, margin_m)
    (image,) = axes.get_images()
    for index, camera in enumerate(site.cameras):
        draw_camera(axes, camera, _colour(index))
    outlines = [
        LineCollection([], colors=_colour(index), linewidths=1.2, zorder=3) for index in range(len(site.cameras))
    ]
    for lines in outlines:
        axes.add_collection(lines)
    dots = axes.scatter([], [], s=34, linewidths=1.2, zorder=7)
    if frame.expected is not None:
        _colour_bar(figure, axes)
    _legend(figure, site)
    title = axes.set_title("\n")
    scene = Scene(figure, axes, site, views, heading, image, tuple(outlines), (*axes.lines, *axes.patches), dots, title)
    scene.show(frame)
    return scene


def _ground(site: Site, views: Views, frame: Frame) -> Float[np.ndarray, "rows columns 3"]:
    """Walls, belief, and over it the tint of every field of view."""
    from matplotlib.colors import to_rgb

    grid = site.grid
    expected = np.zeros(grid.size) if frame.expected is None else frame.expected
    colours = _heat_colours()(_scale()(expected))[:, :3]
    for index in range(len(frame.presets)):
        seen = frame.seen(views, index)
        if seen is not None:
            colours[seen] = (1 - _TINT) * colours[seen] + _TINT * np.array(to_rgb(_colour(index)))
    ground = np.empty((*grid.free.shape, 3))
    ground[:] = to_rgb(WALL)
    ground[grid.free] = colours
    return ground


def _colour(camera: int) -> str:
    return CAMERA_COLOURS[camera % len(CAMERA_COLOURS)]


def _scale() -> Any:
    """Small expectations are told apart, too; more than one target in a cell looks like one."""
    from matplotlib.colors import PowerNorm

    return PowerNorm(0.5, 0, 1, clip=True)


def _heat_colours() -> Any:
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("expected", HEAT_COLOURS)


def _colour_bar(figure: Figure, axes: Axes) -> None:
    from matplotlib.cm import ScalarMappable

    heat = ScalarMappable(norm=_scale(), cmap=_heat_colours())
    bar = figure.colorbar(heat, ax=axes, location="bottom", aspect=50, fraction=0.05, pad=0.02)
    bar.set_label("expected number of targets in a cell, after the sighting", fontsize=8)
    bar.set_ticks(list(_BAR_TICKS), labels=list(_BAR_TICKS.values()))


def _legend(figure: Figure, site: Site) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    dot: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 6}
    entries: list[Any] = [
        Line2D([], [], markerfacecolor=INK, markeredgecolor="#ffffff", label="target, observed", **dot),
        Line2D([], [], markerfacecolor="#ffffff", markeredgecolor=INK, label="target, not observed", **dot),
        Patch(facecolor="none", edgecolor=CAMERA_COLOURS[0], label="field of view now (colour: camera)"),
    ]
    if not site.grid.free.all():
        entries.append(Patch(facecolor=WALL, label="obstacle"))
    figure.legend(handles=entries, loc="outside lower center", ncols=len(entries), frameon=False, fontsize=8)
