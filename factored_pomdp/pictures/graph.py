"""A model's graph: a dynamic influence diagram of two slices.

Circles are chance variables (white: hidden, blue: known, grey: observed), squares actions, diamonds rewards, an octagon
the end of the episode. Blocks of one shape stand once, in a plate. What ties blocks together is drawn in orange.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from factored_pomdp.errors import TooLarge
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.pictures.layout import Box, Layout, Plate, laid_out
from factored_pomdp.pictures.parts import Edge, Kind, Parts, parts_of
from factored_pomdp.pictures.style import COLOURS, INK, PAPER, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

__all__ = ["MOST_NODES", "draw_graph"]

MOST_NODES = 150
"""So many nodes are drawn; more would not be read."""

_FILL: Mapping[Kind, str] = {
    "hidden": PAPER,
    "known": "#cbe4f5",
    "observation": "#d9d9d9",
    "action": "#fdeccb",
    "reward": "#cdeee1",
    "end": PAPER,
}
_NAMES: Mapping[Kind, str] = {
    "hidden": "hidden",
    "known": "known",
    "observation": "observed",
    "action": "action",
    "reward": "reward",
    "end": "end of an episode",
}
_TIE = COLOURS[1]
_FRAME = "#7a7a7a"
_LEGEND_IN = 0.45
_MARGIN_IN = 0.3
_TITLE_IN = 0.55


@styled
def draw_graph(model: FactoredPOMDP) -> Figure:
    """A picture of the model's graph.

    Raises
    ------
    TooLarge
        Where there are more than `MOST_NODES` nodes, those of equal blocks counted once.
    """
    parts = parts_of(model)
    if len(parts.nodes) > MOST_NODES:
        raise TooLarge(f"the graph of {model.name} has {len(parts.nodes):,} nodes; up to {MOST_NODES} are drawn")
    layout = laid_out(parts)
    left, right, bottom, top = layout.extent
    left, right, bottom, top = left - _MARGIN_IN, right + _MARGIN_IN, bottom - _LEGEND_IN, top + _TITLE_IN
    figure = new_figure(right - left, top - bottom)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    axes.set_axis_off()
    for plate in layout.plates:
        _draw_plate(axes, plate)
    patches = {node.key: _draw_node(axes, node.kind, layout.boxes[node.key]) for node in parts.nodes.values()}
    for edge in sorted(parts.edges, key=lambda edge: bool(edge.tie)):
        _draw_edge(axes, edge, layout, patches)
    _name_ties(axes, parts, layout)
    axes.text((left + right) / 2, top - 0.1, _title(model, parts), ha="center", va="top", fontsize=10)
    for x, name in zip(layout.slices, ("now", "next"), strict=True):
        axes.text(x, top - _TITLE_IN + 0.04, name, ha="center", va="bottom", fontsize=8, color=_FRAME)
    _legend(axes, parts)
    return figure


def _draw_node(axes: Axes, kind: Kind, box: Box) -> Patch:
    from matplotlib.patches import Ellipse, FancyBboxPatch, Polygon

    style: dict[str, Any] = {"facecolor": _FILL[kind], "edgecolor": INK, "linewidth": 0.9, "zorder": 3}
    half, tall = box.width / 2, box.height / 2
    patch: Patch
    if kind == "action":
        corner = box.x - half + 0.03, box.y - tall + 0.03
        patch = FancyBboxPatch(corner, box.width - 0.06, box.height - 0.06, boxstyle="square,pad=0.03", **style)
    elif kind == "reward":
        patch = Polygon(
            [(box.x - half, box.y), (box.x, box.y + tall), (box.x + half, box.y), (box.x, box.y - tall)], **style
        )
    elif kind == "end":
        cut = 0.1
        corners = [(-half, cut - tall), (cut - half, -tall), (half - cut, -tall), (half, cut - tall)]
        corners += [(-x, -y) for x, y in corners]
        patch = Polygon([(box.x + x, box.y + y) for x, y in corners], **style)
    else:
        patch = Ellipse((box.x, box.y), box.width, box.height, **style)
    axes.add_patch(patch)
    axes.text(
        box.x, box.y, "\n".join(box.lines), ha="center", va="center_baseline", fontsize=7, zorder=4, linespacing=1.0
    )
    return patch


def _draw_edge(axes: Axes, edge: Edge, layout: Layout, patches: Mapping[str, Patch]) -> None:
    from matplotlib.patches import FancyArrowPatch

    start, end = layout.boxes[edge.start], layout.boxes[edge.end]
    axes.add_patch(
        FancyArrowPatch(
            (start.x, start.y),
            (end.x, end.y),
            patchA=patches[edge.start],
            patchB=patches[edge.end],
            shrinkA=0,
            shrinkB=1,
            arrowstyle="-" if edge.tie == "initial" else "-|>",
            mutation_scale=8,
            connectionstyle=f"arc3,rad={layout.bends[edge]}",
            color=_TIE if edge.tie else INK,
            linewidth=1.6 if edge.tie else 0.7,
            zorder=2,
        )
    )


def _draw_plate(axes: Axes, plate: Plate) -> None:
    from matplotlib.patches import FancyBboxPatch

    frame = FancyBboxPatch(
        (plate.left + 0.08, plate.bottom + 0.08),
        plate.right - plate.left - 0.16,
        plate.top - plate.bottom - 0.16,
        boxstyle="round,pad=0.08",
        facecolor="none",
        edgecolor=_FRAME,
        linewidth=1.1,
        zorder=1,
    )
    axes.add_patch(frame)
    axes.text(
        plate.right - 0.1, plate.bottom + 0.07, plate.caption, ha="right", va="bottom", fontsize=8, color="#4d4d4d"
    )


def _name_ties(axes: Axes, parts: Parts, layout: Layout) -> None:
    """Say at the node where a tie comes about of which kind it is."""
    named = {(edge.end, edge.tie) for edge in parts.edges if edge.tie}
    for key, kind in sorted(named):
        box = layout.boxes[key]
        style: dict[str, Any] = {"fontsize": 7, "color": _TIE, "zorder": 5, "fontweight": "bold"}
        last = box.x > max(layout.slices)
        at = box.x + (0 if last else 0.04), box.y - box.height / 2 - 0.04
        axes.text(*at, f"{kind} tie", ha="center" if last else "left", va="top", **style)


def _title(model: FactoredPOMDP, parts: Parts) -> str:
    blocks = sum(band.shape.times for band in parts.bands if band.shape is not None)
    ties = sorted({edge.tie for edge in parts.edges if edge.tie})
    held = f"; {', '.join(ties)} tie{'s' if len(ties) > 1 else ''}" if ties else ""
    return f"{model.name}: {blocks} block{'s' if blocks != 1 else ''}{held}"


def _legend(axes: Axes, parts: Parts) -> None:
    from matplotlib.lines import Line2D

    kinds = {node.kind for node in parts.nodes.values()}
    shapes: Mapping[Kind, str] = {
        "hidden": "o",
        "known": "o",
        "observation": "o",
        "action": "s",
        "reward": "D",
        "end": "8",
    }
    handles = [
        Line2D(
            [], [], marker=shapes[kind], linestyle="", markersize=7, markerfacecolor=_FILL[kind], markeredgecolor=INK,
            markeredgewidth=0.8, label=name,
        )
        for kind, name in _NAMES.items()
        if kind in kinds
    ]  # fmt: skip
    if any(edge.tie for edge in parts.edges):
        handles.append(Line2D([], [], color=_TIE, linewidth=1.6, label="tie"))
    axes.legend(
        handles=handles, loc="lower center", ncols=len(handles), frameon=False, fontsize=7.5, handletextpad=0.2,
        columnspacing=1.0, borderaxespad=0.1,
    )  # fmt: skip
