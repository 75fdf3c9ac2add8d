"""The map of the page: walls, belief, fields of view, cameras and where they look, targets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float, Float32, Float64

from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.elsewhere import Elsewhere, Place
from surveillance_domain.page.palette import camera_colour, heat_palette
from surveillance_domain.page.snapshot import CameraSnapshot, Snapshot
from surveillance_domain.pictures.floor import extent_m, outline_m
from surveillance_domain.pictures.style import INK, WALL
from surveillance_domain.site.grid import Grid

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource
    from bokeh.plotting import figure

__all__ = ["FloorPlan", "heat_of", "runs_m"]

_HEAT_STEPS = 1024
_MOST_NAMED = 8
"""Targets whose names stand beside them; more would hide the map."""
_MARGIN, _ARROW = 0.03, 0.07
"""Shares of the map's longer side."""
_AWAY = "#8c8c8c"
_IN_VIEW, _BEYOND = ("square", 19), ("diamond", 26)
"""Marks of sightings, in pixels; Bokeh's diamonds are slim."""


class FloorPlan:
    """A figure for one browser.

    Attributes
    ----------
    figure : bokeh.plotting.figure
    aspect : float
        Its width over its height.
    """

    def __init__(self, surveillance: Surveillance) -> None:
        from bokeh.models import ColumnDataSource, Range1d
        from bokeh.plotting import figure

        self._surveillance, self._grid = surveillance, surveillance.site.grid
        self._shown_views: list[tuple[int | None, Place | None]] = [(None, None)] * len(surveillance.site.cameras)
        self._elsewhere = Elsewhere(surveillance.site)
        left, right, bottom, top = _extent_with_cameras(surveillance)
        self._arrow_m = _ARROW * max(right - left, top - bottom)
        self.aspect = (right - left) / (top - bottom)
        self.figure: figure = figure(
            name="map",
            x_range=Range1d(left, right),
            y_range=Range1d(bottom, top),
            aspect_ratio=self.aspect,
            sizing_mode="scale_width",
            min_border=0,
            toolbar_location=None,
            tools="",
            outline_line_color=None,
            background_fill_alpha=0,
            border_fill_alpha=0,
        )
        self.figure.axis.visible = False
        self.figure.grid.visible = False
        self._heat: ColumnDataSource = ColumnDataSource({"image": [heat_of(None, self._grid)]}, name="heat")
        self._fields = [ColumnDataSource(_quads(self._grid, None), name=f"field-{n}") for n in self._numbers]
        self._edges = [ColumnDataSource(_segments(self._grid, None)) for _ in self._numbers]
        self._cameras = ColumnDataSource(self._marked(()), name="cameras")
        self._arrows = ColumnDataSource({"x0": [], "y0": [], "x1": [], "y1": []}, name="arrows")
        self._sightings = ColumnDataSource({"x": [], "y": [], "marker": [], "size": []}, name="sightings")
        self._truth = ColumnDataSource({"x": [], "y": [], "fill": [], "line": [], "name": []}, name="truth")
        self._draw()

    def show(self, snapshot: Snapshot, target: str | None) -> None:
        """Set everything to a step.

        Parameters
        ----------
        target : str or None
            Whose belief; ``None``: the sum over all targets.
        """
        self.show_belief(snapshot, target)
        for number, camera in enumerate(snapshot.cameras):
            if (camera.view, camera.place) != self._shown_views[number]:
                self._shown_views[number] = (camera.view, camera.place)
                member = self._member(number, camera.view, camera.place)
                self._fields[number].data = _quads(self._grid, member)
                self._edges[number].data = _segments(self._grid, member)
        self._cameras.data = self._marked(snapshot.cameras)
        self._arrows.data = self._pointing(snapshot.cameras)
        seen = np.array(list(snapshot.seen_at.values()), dtype=float).reshape(-1, 2)
        centres = (seen + 0.5) * self._grid.cell_m + np.asarray(self._grid.origin_m)
        shapes = [_BEYOND if target in snapshot.beyond else _IN_VIEW for target in snapshot.seen_at]
        marker, size = [shape for shape, _ in shapes], [pixels for _, pixels in shapes]
        x, y = centres.T.tolist()
        self._sightings.data = {"x": x, "y": y, "marker": marker, "size": size}
        self._truth.data = self._true(snapshot)

    def show_belief(self, snapshot: Snapshot, target: str | None) -> None:
        """Set the heat map alone to the belief of a target, or of all."""
        wanted = [target is None or one == target for one in snapshot.targets]
        belief = None if snapshot.belief is None else snapshot.belief[wanted]
        self._heat.data = {"image": [heat_of(belief, self._grid)]}

    @property
    def _numbers(self) -> range:
        return range(len(self._surveillance.site.cameras))

    def _draw(self) -> None:
        from bokeh.models import HoverTool, LinearColorMapper

        grid, plan = self._grid, self.figure
        left, right, bottom, top = extent_m(grid)
        place: dict[str, Any] = {"x": left, "y": bottom, "dw": right - left, "dh": top - bottom}
        colours = LinearColorMapper(heat_palette(_HEAT_STEPS), low=0, high=1, nan_color=WALL)
        heat = plan.image("image", source=self._heat, color_mapper=colours, **place)
        for number in self._numbers:
            colour = camera_colour(number)
            plan.quad(
                "left", "right", "bottom", "top", source=self._fields[number], color=colour, alpha=0.16, line_width=0
            )
            plan.segment(
                "x0", "y0", "x1", "y1", source=self._edges[number], color=colour, line_width=2, line_cap="square"
            )
        plan.quad([left], [right], [bottom], [top], fill_alpha=0, line_color=INK)
        plan.segment("x0", "y0", "x1", "y1", source=self._arrows, color=INK, line_width=3)
        cameras = plan.scatter(
            "x",
            "y",
            source=self._cameras,
            marker="marker",
            size=15,
            fill_color="fill",
            line_color="line",
            line_width=2.5,
        )
        for colour, width in (("#ffffff", 4), (INK, 1.5)):  # to be seen on light ground and on dark
            plan.scatter(
                "x",
                "y",
                source=self._sightings,
                marker="marker",
                size="size",
                fill_alpha=0,
                line_color=colour,
                line_width=width,
            )
        plan.scatter("x", "y", source=self._truth, size=11, fill_color="fill", line_color="line", line_width=1.5)
        label: dict[str, Any] = {"x_offset": 9, "text_baseline": "middle", "text_font_size": "12px", "text_color": INK}
        plan.text(
            "x", "y", "name", source=self._truth, background_fill_color="white", background_fill_alpha=0.7, **label
        )
        plan.add_tools(HoverTool(renderers=[heat], tooltips=[("expected here", "@image{0.000}")]))
        plan.add_tools(HoverTool(renderers=[cameras], tooltips="@name"))

    def _member(self, camera: int, view: int | None, place: Place | None) -> Bool[np.ndarray, "rows columns"] | None:
        if view is not None:
            seen: Float[np.ndarray, " cells"] | None = self._surveillance.views.detection[camera][view]
        elif place is not None:
            seen = self._elsewhere.detection(self._surveillance.site.cameras[camera].name, place)
        else:
            seen = None
        if seen is None:
            return None
        member = np.zeros(self._grid.free.shape, dtype=bool)
        member[self._grid.free] = seen > 0
        return member

    def _marked(self, cameras: tuple[CameraSnapshot, ...]) -> dict[str, list[Any]]:
        """A camera with a view is a full disk, one without a grey cross."""
        places = [camera.mount.position_m for camera in self._surveillance.site.cameras]
        has_view = [camera.has_view for camera in cameras] or [False] * len(places)
        return {
            "x": [x for x, _, _ in places],
            "y": [y for _, y, _ in places],
            "name": [camera.name for camera in self._surveillance.site.cameras],
            "marker": ["circle" if one else "x" for one in has_view],
            "fill": [camera_colour(n) for n in self._numbers],
            "line": [INK if one else _AWAY for one in has_view],
        }

    def _pointing(self, cameras: tuple[CameraSnapshot, ...]) -> dict[str, list[float]]:
        places = [camera.mount.position_m for camera in self._surveillance.site.cameras]
        known = [(x, y, one.heading) for (x, y, _), one in zip(places, cameras, strict=True) if one.heading is not None]
        return {
            "x0": [x for x, _, _ in known],
            "y0": [y for _, y, _ in known],
            "x1": [x + self._arrow_m * heading[0] for x, _, heading in known],
            "y1": [y + self._arrow_m * heading[1] for _, y, heading in known],
        }

    def _true(self, snapshot: Snapshot) -> dict[str, list[Any]]:
        truth = snapshot.truth_m or {}
        return {
            "x": [x for x, _ in truth.values()],
            "y": [y for _, y in truth.values()],
            "fill": [INK if target in snapshot.seen_at else "#ffffff" for target in truth],
            "line": ["#ffffff" if target in snapshot.seen_at else INK for target in truth],
            "name": [target if len(truth) <= _MOST_NAMED else "" for target in truth],
        }


def heat_of(belief: Float32[np.ndarray, "targets cells"] | None, grid: Grid) -> Float32[np.ndarray, "rows columns"]:
    """Expected number of targets in each cell, summed over targets; nan where there is a wall, 0 without a belief."""
    heat = np.full(grid.free.shape, np.nan, dtype=np.float32)
    heat[grid.free] = 0.0 if belief is None else belief.sum(axis=0)
    return heat


def runs_m(grid: Grid, member: Bool[np.ndarray, "rows columns"]) -> Float64[np.ndarray, "runs 4"]:
    """One rectangle for each unbroken run of a set's cells in a row: left, right, bottom and top in metres."""
    steps = np.diff(np.pad(member, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    row, first = np.nonzero(steps == 1)
    last = np.nonzero(steps == -1)[1]
    x, y = grid.origin_m
    return np.stack(
        [x + first * grid.cell_m, x + last * grid.cell_m, y + row * grid.cell_m, y + (row + 1) * grid.cell_m], 1
    )


def _quads(grid: Grid, member: Bool[np.ndarray, "rows columns"] | None) -> dict[str, list[float]]:
    columns = np.empty((4, 0)) if member is None else runs_m(grid, member).T
    return dict(zip(("left", "right", "bottom", "top"), columns.tolist(), strict=True))


def _segments(grid: Grid, member: Bool[np.ndarray, "rows columns"] | None) -> dict[str, list[float]]:
    ends = np.empty((0, 2, 2)) if member is None else outline_m(grid, member)
    return dict(zip(("x0", "y0", "x1", "y1"), ends.reshape(-1, 4).T.tolist(), strict=True))


def _extent_with_cameras(surveillance: Surveillance) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of map and cameras, with a margin, in metres."""
    left, right, bottom, top = extent_m(surveillance.site.grid)
    xs, ys, _ = zip(*(camera.mount.position_m for camera in surveillance.site.cameras), strict=True)
    left, right, bottom, top = min(left, *xs), max(right, *xs), min(bottom, *ys), max(top, *ys)
    margin = _MARGIN * max(right - left, top - bottom)
    return left - margin, right + margin, bottom - margin, top + margin
