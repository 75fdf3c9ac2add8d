"""A night in one picture: share of targets seen, share of the floor in view, and which camera was missing when."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_night"]

_BINS = 120
_UNWATCHED = "#f4c7b0"
_WIDTH_IN, _HEIGHT_IN = 8.0, 5.0


@styled
def draw_night(
    hours: Float[np.ndarray, " steps"],
    seen: Float[np.ndarray, " steps"],
    coverage: Float[np.ndarray, " steps"],
    gaps: Mapping[str, Sequence[tuple[float, float]]],
    seen_label: str,
    unwatched: Sequence[tuple[float, float]] = (),
) -> Figure:
    """Means over at most 120 spans of time, and a line for each camera.

    Parameters
    ----------
    hours : (steps,) float
        Since the beginning.
    seen, coverage : (steps,) float
        Shares, 0 to 1; nan where not known.
    gaps : dict
        For each camera the hours at which it began and ceased to be missing.
    seen_label : str
        What the share of ``seen`` is of.
    unwatched : sequence of (float, float)
        The hours from when to when nobody watched.
    """
    figure = new_figure(_WIDTH_IN, _HEIGHT_IN)
    above, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 0.35 * len(gaps) + 0.2])
    centres, shares = binned(hours, np.column_stack([seen, coverage]))
    for column, label, style in ((0, seen_label, "-"), (1, "floor in view", "--")):
        if np.isfinite(shares[:, column]).any():
            colour = INK if column else CAMERA_COLOURS[0]
            above.plot(centres, 100 * shares[:, column], style, marker=".", markersize=2, color=colour, label=label)
    for number, (start, end) in enumerate(unwatched):
        for axes, label in ((above, "nobody watched"), (below, "")):
            axes.axvspan(start, end, color=_UNWATCHED, linewidth=0, zorder=0, label="" if number else label)
    above.set_ylim(0, 103)
    above.set_ylabel("%")
    figure.legend(loc="outside upper center", frameon=False, ncols=3)
    for row, spans in enumerate(gaps.values()):
        colour = CAMERA_COLOURS[row % len(CAMERA_COLOURS)]
        below.plot([hours[0], hours[-1]], [row, row], color=colour, linewidth=1, zorder=1)
        below.broken_barh([(start, end - start) for start, end in spans], (row - 0.3, 0.6), facecolors=INK, zorder=2)
    below.set_yticks(range(len(gaps)), labels=list(gaps))
    below.set_ylim(len(gaps) - 0.4, -0.6)
    below.set_xlabel("hours since the record began; black: without a view")
    for side in ("top", "right"):
        above.spines[side].set_visible(False)
        below.spines[side].set_visible(False)
    return figure


def binned(
    hours: Float[np.ndarray, " steps"], values: Float[np.ndarray, "steps columns"]
) -> tuple[Float[np.ndarray, " bins"], Float[np.ndarray, "bins columns"]]:
    """Centres and means of equal spans of time; nan where a column has nothing in a span."""
    count = min(_BINS, len(hours))
    edges = np.linspace(hours[0], max(hours[-1], hours[0] + 1e-9), count + 1)
    number = np.clip(np.searchsorted(edges, hours, side="right") - 1, 0, count - 1)
    means = np.full((count, values.shape[1]), np.nan)
    for column in range(values.shape[1]):
        known = np.isfinite(values[:, column])
        totals = np.bincount(number[known], weights=values[known, column], minlength=count)
        amounts = np.bincount(number[known], minlength=count)
        means[amounts > 0, column] = totals[amounts > 0] / amounts[amounts > 0]
    return (edges[:-1] + edges[1:]) / 2, means
