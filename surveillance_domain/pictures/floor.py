"""The ground of every picture of a site: walls, free floor, cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.pictures.style import FREE, INK, WALL
from surveillance_domain.site.camera import Camera
from surveillance_domain.site.grid import Grid

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_camera", "draw_cells", "draw_floor", "extent_m", "outline_m"]


def extent_m(grid: Grid) -> tuple[float, float, float, float]:
    """Left, right, bottom and top of the map in metres, as matplotlib's images take it."""
    x, y = grid.origin_m
    return x, x + grid.columns * grid.cell_m, y, y + grid.rows * grid.cell_m


def draw_floor(axes: Axes, grid: Grid, margin_m: float = 0.0) -> None:
    """Walls dark, floor light, in metres; axes of equal scale without ticks."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Rectangle

    left, right, bottom, top = extent_m(grid)
    axes.imshow(
        grid.free,
        origin="lower",
        extent=(left, right, bottom, top),
        cmap=ListedColormap([WALL, FREE]),
        vmin=0,
        vmax=1,
        interpolation="nearest",
    )
    axes.add_patch(Rectangle((left, bottom), right - left, top - bottom, fill=False, edgecolor=INK, linewidth=0.8))
    axes.set_xlim(left - margin_m, right + margin_m)
    axes.set_ylim(bottom - margin_m, top + margin_m)
    axes.set_aspect("equal")
    axes.set_axis_off()


def draw_cells(axes: Axes, grid: Grid, cells: Bool[np.ndarray, " cells"], colour: str, alpha: float = 0.35) -> None:
    """A set of free cells as one tinted area with a firm outline, which a print without colour keeps."""
    from matplotlib.collections import LineCollection
    from matplotlib.colors import to_rgba

    member = np.zeros(grid.free.shape, dtype=bool)
    member[grid.free] = cells
    tint = np.zeros((*member.shape, 4))
    tint[member] = to_rgba(colour, alpha)
    axes.imshow(tint, origin="lower", extent=extent_m(grid), interpolation="nearest", zorder=2)
    lines = LineCollection(
        list(outline_m(grid, member)), colors=colour, linewidths=1.0, capstyle="projecting", zorder=3
    )
    axes.add_collection(lines)


def outline_m(grid: Grid, member: Bool[np.ndarray, "rows columns"]) -> Float[np.ndarray, "edges 2 2"]:
    """The edges between cells that belong and cells that do not, as (edges, 2 ends, 2) in metres."""
    padded = np.pad(member, 1)
    row, column = np.nonzero(padded[1:-1, 1:] != padded[1:-1, :-1])
    upright = np.stack([np.stack([column, row], 1), np.stack([column, row + 1], 1)], 1)
    row, column = np.nonzero(padded[1:, 1:-1] != padded[:-1, 1:-1])
    level = np.stack([np.stack([column, row], 1), np.stack([column + 1, row], 1)], 1)
    return np.concatenate([upright, level]) * grid.cell_m + np.asarray(grid.origin_m)


def draw_camera(axes: Axes, camera: Camera, colour: str, size_pt: float = 6.0) -> None:
    """A camera at its place."""
    x, y, _ = camera.mount.position_m
    axes.plot(
        [x],
        [y],
        marker="o",
        markersize=size_pt,
        color=colour,
        markeredgecolor=INK,
        markeredgewidth=0.8,
        zorder=5,
        clip_on=False,
    )
