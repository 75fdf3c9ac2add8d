"""Alpha vectors over one probability: lines coloured by action, their upper surface, and the bound from above."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from factored_pomdp.pictures.style import COLOURS, INK, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["draw_vectors"]

_DASHES = ("-", (0, (5, 2)), (0, (1, 1)))
_ROOM = 0.22
_STRIP = 0.045
_MOSTLY = 0.98


@styled
def draw_vectors(shown: Any, title: str) -> Figure:
    """The value function of a problem with two states.

    Each vector is a thin line; the part of it that is the best is thick. The strip at the foot says which action is
    taken where. The upper bound is dashed, the gap between both bounds shaded.

    Parameters
    ----------
    shown : object
        ``axis`` (name of the state whose probability is drawn), ``vectors`` (K, 2) (values at probability 0 and 1),
        ``actions`` (K,), ``names`` of all actions, ``probabilities``, ``lower`` and ``upper`` (P,).
    """
    from matplotlib.lines import Line2D

    figure = new_figure(6.0, 4.0)
    axes = figure.add_subplot()
    where = shown.probabilities
    worth = np.outer(1 - where, shown.vectors[:, 0]) + np.outer(where, shown.vectors[:, 1])
    best = worth.argmax(axis=1)
    for number, action in enumerate(shown.actions):
        style = _style(int(action))
        axes.plot(where, worth[:, number], linewidth=0.6, alpha=0.45, zorder=2, **style)
        at_best = np.where(_with_neighbours(best == number), worth[:, number], np.nan)
        axes.plot(where, at_best, linewidth=2.2, solid_capstyle="butt", zorder=3, **style)
    loose = bool((shown.upper - shown.lower > 1e-9 * np.abs(shown.lower).max(initial=1.0)).any())
    if loose:
        axes.fill_between(where, shown.lower, shown.upper, color=INK, alpha=0.12, linewidth=0, zorder=1)
        axes.plot(where, shown.upper, color=INK, linewidth=1.0, linestyle=(0, (4, 2)), zorder=4)
    _scale(axes, shown.lower, shown.upper)
    _strip(axes, where, shown.actions[best])
    taken = dict.fromkeys(int(action) for action in shown.actions)
    handles = [Line2D([], [], linewidth=2.2, label=shown.names[action], **_style(action)) for action in sorted(taken)]
    if loose:
        handles.append(Line2D([], [], color=INK, linewidth=1.0, linestyle=(0, (4, 2)), label="upper bound"))
    axes.set_xlabel(f"probability of {shown.axis}")
    axes.set_ylabel("value")
    axes.set_title(title)
    axes.spines[["top", "right"]].set_visible(False)
    figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), frameon=False)
    return figure


def _style(action: int) -> dict[str, Any]:
    """A colour, and beyond the last one another dash."""
    return {
        "color": COLOURS[action % len(COLOURS)],
        "linestyle": _DASHES[action // len(COLOURS) % len(_DASHES)],
    }


def _with_neighbours(chosen: np.ndarray) -> np.ndarray:
    """One point more on either side, so that neighbouring pieces meet."""
    wider = chosen.copy()
    wider[1:] |= chosen[:-1]
    wider[:-1] |= chosen[1:]
    return wider


def _scale(axes: Axes, lower: np.ndarray, upper: np.ndarray) -> None:
    """The lower bound in full; vectors far below it are cut off, and where the upper one shoots up at the ends."""
    low, high = float(lower.min()), max(float(lower.max()), float(np.quantile(upper, _MOSTLY)))
    height = (high - low) or max(1.0, abs(high))
    axes.set_xlim(0, 1)
    axes.set_ylim(low - _ROOM * height, high + 0.06 * height)


def _strip(axes: Axes, where: np.ndarray, actions: np.ndarray) -> None:
    """Which action is taken where, as a strip at the foot."""
    edges = np.flatnonzero(np.diff(actions)) + 1
    cuts = [0.0, *((where[edges - 1] + where[edges]) / 2), 1.0]
    for start, end, action in zip(cuts, cuts[1:], actions[[0, *edges]], strict=False):
        axes.axvspan(start, end, ymax=_STRIP, color=_style(int(action))["color"], linewidth=0, zorder=5)
