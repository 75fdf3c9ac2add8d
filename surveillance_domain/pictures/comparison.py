"""The paper's figure: PercentObs against the number of targets, a panel for each site, a line for each controller.

Lines differ in colour, in dash and in marker, and carry their names beside their ends, so that the colour-blind and a
print without colours can tell them apart. Bands are confidence intervals; bounds are thin and dashed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["Curve", "Panel", "draw_comparison", "spread"]

BLUE, VERMILLION, GREEN, PINK, SKY, ORANGE = CAMERA_COLOURS
_BOUND = {"color": "#6b6b6b", "linewidth": 0.9, "marker": None}
_LOOKS: dict[str, dict[str, Any]] = {
    "pomdp": {"color": BLUE, "linewidth": 2.2, "linestyle": "-", "marker": "o"},
    "msp": {"color": GREEN, "linestyle": (0, (6, 1.5)), "marker": "^"},
    "mp": {"color": VERMILLION, "linestyle": (0, (5, 1.5, 1, 1.5)), "marker": "s"},
    "stat": {"color": ORANGE, "linestyle": (0, (2, 1.2)), "marker": "v"},
    "sys": {"color": PINK, "linestyle": (0, (1, 1.2)), "marker": "D"},
    "full-information": {**_BOUND, "linestyle": (0, (4, 3))},
    "clairvoyant": {**_BOUND, "linestyle": (0, (1.5, 2.5))},
}
_OTHERS = ({"color": SKY, "linestyle": "-", "marker": "P"}, {"color": INK, "linestyle": "--", "marker": "X"})
_PANEL_IN = (3.7, 3.4)
_PANELS_A_ROW = 3
_LABEL_POINTS = 9.5
_MOST_TICKS = 8


@dataclass(frozen=True)
class Curve:
    """One line.

    Attributes
    ----------
    controller : str
        Decides the looks; names that are not the paper's take what is left.
    label : str
    targets : tuple of int
        In ascending order.
    mean, low, high : tuple of float
        PercentObs and its interval; an infinite end is left out.
    """

    controller: str
    label: str
    targets: tuple[int, ...]
    mean: tuple[float, ...]
    low: tuple[float, ...]
    high: tuple[float, ...]


@dataclass(frozen=True)
class Panel:
    """One site."""

    title: str
    curves: tuple[Curve, ...]


@styled
def draw_comparison(panels: Sequence[Panel], title: str, note: str = "") -> Figure:
    """Draw one panel a site; all share the scale of PercentObs."""
    columns = min(len(panels), _PANELS_A_ROW)
    rows = math.ceil(len(panels) / columns)
    figure = new_figure(max(_PANEL_IN[0] * columns, 5.0), _PANEL_IN[1] * rows + 0.7)
    axes = figure.subplots(rows, columns, sharey=True, squeeze=False)
    low, high = _scale(panels)
    for place, one in enumerate(axes.flat):
        if place >= len(panels):
            one.set_axis_off()
            continue
        one.set_ylim(low, high)
        _draw_panel(one, panels[place])
        if place % columns == 0:
            one.set_ylabel("PercentObs (% of targets observed)")
    figure.suptitle(title)
    if note:
        figure.supxlabel(note, fontsize=8)
    return figure


def _scale(panels: Sequence[Panel]) -> tuple[float, float]:
    """From a multiple of ten below everything to one above."""
    ends = [
        end
        for panel in panels
        for curve in panel.curves
        for triple in zip(curve.mean, curve.low, curve.high, strict=True)
        for end in triple
        if math.isfinite(end)
    ]
    if not ends:
        return 0.0, 100.0
    return max(0.0, 10.0 * math.floor(min(ends) / 10)), min(102.0, 10.0 * math.ceil(max(ends) / 10 + 0.1))


def _draw_panel(axes: Axes, panel: Panel) -> None:
    others = iter(_OTHERS * len(panel.curves))
    looks = {curve.controller: _LOOKS.get(curve.controller) or next(others) for curve in panel.curves}
    for curve in panel.curves:
        look = {
            "linewidth": 1.4,
            "markersize": 5 if len(curve.targets) <= _MOST_TICKS else 3,
            **looks[curve.controller],
        }
        bound = look["marker"] is None
        if len(curve.targets) == 1:
            look["marker"] = look["marker"] or "_"
        axes.plot(
            curve.targets, curve.mean, markeredgecolor="white", markeredgewidth=0.5, zorder=2 if bound else 3, **look
        )
        _draw_interval(axes, curve, str(look["color"]), bound)
    targets = sorted({count for curve in panel.curves for count in curve.targets})
    axes.set_xticks(_ticks(targets))
    width = max(targets[-1] - targets[0], 1)
    axes.set_xlim(targets[0] - 0.05 * width, targets[-1] + 0.05 * width)
    axes.set_xlabel("number m of targets")
    axes.set_title(panel.title, fontsize=10, fontweight="bold")
    axes.grid(axis="y", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)
    _write_labels(axes, panel, {name: str(look["color"]) for name, look in looks.items()})


def _ticks(targets: Sequence[int]) -> list[int]:
    """All numbers where they are few, else the first and the fifth, tenth, ..."""
    few = len(targets) <= _MOST_TICKS
    return [count for count in targets if few or count == targets[0] or count % 5 == 0]


def _draw_interval(axes: Axes, curve: Curve, colour: str, bound: bool) -> None:
    low, high = np.array(curve.low), np.array(curve.high)
    known = np.isfinite(low) & np.isfinite(high)
    if len(curve.targets) == 1:
        if known[0]:
            axes.plot([curve.targets[0]] * 2, [low[0], high[0]], color=colour, linewidth=1.0, zorder=1)
        return
    axes.fill_between(
        curve.targets, low, high, where=known, color=colour, alpha=0.10 if bound else 0.20, linewidth=0, zorder=1
    )


def _write_labels(axes: Axes, panel: Panel, colours: dict[str, str]) -> None:
    """Names beside the right ends, moved apart where lines end close together."""
    ends = np.array([curve.mean[-1] for curve in panel.curves])
    bottom, top = axes.get_ylim()
    height_points = _PANEL_IN[1] * 72 * 0.68
    gap = (top - bottom) * _LABEL_POINTS / height_points
    for curve, end, height in zip(panel.curves, ends, spread(ends, gap, bottom, top), strict=True):
        axes.annotate(
            curve.label,
            xy=(curve.targets[-1], float(end)),
            xytext=(1.06, float(height)),
            textcoords=axes.get_yaxis_transform(),
            va="center",
            fontsize=8,
            fontweight="bold" if curve.controller == "pomdp" else "normal",
            color=colours[curve.controller],
            arrowprops={"arrowstyle": "-", "color": colours[curve.controller], "linewidth": 0.5, "shrinkB": 4},
        )


def spread(
    heights: Float[np.ndarray, " labels"], gap: float, bottom: float, top: float
) -> Float[np.ndarray, " labels"]:
    """Heights near to the given ones, in the same order, at least ``gap`` apart, and between bottom and top.

    The nearest in least squares, by pooling neighbours (isotonic regression of ``heights − rank · gap``).
    """
    order = np.argsort(heights, kind="stable")
    wanted = heights[order] - gap * np.arange(len(heights))
    pools: list[tuple[float, int]] = []
    for value in wanted.tolist():
        pools.append((value, 1))
        while len(pools) > 1 and pools[-2][0] > pools[-1][0]:
            (first, n), (second, k) = pools[-2:]
            pools[-2:] = [((first * n + second * k) / (n + k), n + k)]
    placed = np.concatenate([np.full(count, value) for value, count in pools])
    placed = np.clip(placed, bottom, max(bottom, top - gap * (len(heights) - 1))) + gap * np.arange(len(heights))
    result = np.empty_like(placed)
    result[order] = placed
    return result
