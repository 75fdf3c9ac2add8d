"""What was learned from people: predicted beside real displacements, and the two distributions that were fitted."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["FittedMotion", "SeenWhere", "draw_motion_fit"]

_BLUE, _VERMILLION = CAMERA_COLOURS[:2]
_BINS = 60
_CUT = 0.995
_SAMPLES = 200_000
_DOTS = 3000
_LINES = (0.5, 0.9)


@dataclass(frozen=True, eq=False)
class FittedMotion:
    """What is drawn.

    Attributes
    ----------
    before_m, after_m : (pairs, 2) float
        Successive displacements of people of whom the model learned nothing.
    turns_deg : (walking,) float
        Changes of direction of those who walk.
    speeds_mps : (moves,) float
    sigma_direction_deg, sigma_speed_mps : float
    speed_set_mps : tuple of float
    step_s, still_mps : float
    """

    before_m: Float[np.ndarray, "pairs 2"]
    after_m: Float[np.ndarray, "pairs 2"]
    turns_deg: Float[np.ndarray, " walking"]
    speeds_mps: Float[np.ndarray, " moves"]
    sigma_direction_deg: float
    sigma_speed_mps: float
    speed_set_mps: tuple[float, ...]
    step_s: float
    still_mps: float


@dataclass(frozen=True, eq=False)
class SeenWhere:
    """Share of the time that people spend in each cell.

    Attributes
    ----------
    origin_m : (float, float)
        Lower-left corner.
    cell_m : float
    probability : (rows, columns) float
        Row 0 is the lowest.
    """

    origin_m: tuple[float, float]
    cell_m: float
    probability: Float[np.ndarray, "rows columns"]


@styled
def draw_motion_fit(
    fitted: FittedMotion, title: str, rng: np.random.Generator, note: str = "", where: SeenWhere | None = None
) -> Figure:
    """Four panels, and a fifth of where people were; ``rng`` draws what the model predicts, ``note`` stands below."""
    figure = new_figure(7.6 if where is None else 11.4, 6.4)
    panels: Any = figure.add_gridspec(2, 2 if where is None else 3)
    axes = np.array([[figure.add_subplot(panels[row, column]) for column in (0, 1)] for row in (0, 1)])
    _draw_displacements(axes[0], fitted, rng)
    _draw_turns(axes[1, 0], fitted)
    _draw_speeds(axes[1, 1], fitted)
    if where is not None:
        _draw_where(figure.add_subplot(panels[:, 2]), where)
    figure.suptitle(title)
    if note:
        figure.supxlabel(note, fontsize=8)
    return figure


def _draw_where(axes: Axes, where: SeenWhere) -> None:
    """Percent of the time in each cell; a light cell is one that people hardly enter."""
    from matplotlib.colors import PowerNorm

    rows, columns = where.probability.shape
    (left, bottom), side = where.origin_m, where.cell_m
    percent = 100 * where.probability
    shown = axes.imshow(
        percent,
        origin="lower",
        extent=(left, left + columns * side, bottom, bottom + rows * side),
        cmap="Blues",
        norm=PowerNorm(0.5, 0, percent.max()),
        interpolation="nearest",
    )
    axes.set(title=f"where people are: prior, cells of {side:g} m", xlabel="x (m)", ylabel="y (m)")
    axes.figure.colorbar(shown, ax=axes, label="percent of the time", shrink=0.4)


def _draw_displacements(axes: Any, fitted: FittedMotion, rng: np.random.Generator) -> None:
    """Where people who walk are one step later, seen along their last move; lines hold half and nine tenths."""
    from matplotlib.colors import LinearSegmentedColormap, PowerNorm
    from matplotlib.lines import Line2D

    real, predicted = _along_last_move(fitted), _predicted(fitted, rng)
    both = np.concatenate([real, predicted])
    right = float(np.quantile(both[:, 0], _CUT)) * 1.08
    left = min(float(np.quantile(both[:, 0], 1 - _CUT)), -0.1 * right)
    side = max(float(np.quantile(np.abs(both[:, 1]), _CUT)), 0.3 * (right - left))
    extent = (left, right, -side, side)
    density = _density(predicted, extent)
    levels = {share: _level(density, share) for share in _LINES}
    colours = LinearSegmentedColormap.from_list("density", ["#ffffff", "#a6c8e0", _BLUE, "#00263d"])
    axes[0].imshow(
        density.T,
        origin="lower",
        extent=extent,
        cmap=colours,
        norm=PowerNorm(0.5, 0, density.max()),
        aspect="auto",
        interpolation="bilinear",
    )
    axes[1].plot(*real[rng.permutation(len(real))[:_DOTS]].T, ".", color=_BLUE, markersize=2.5, alpha=0.5)
    held = {share: _share_within(real, density, level, extent) for share, level in levels.items()}
    for one, name in zip(axes, ("predicted", "real, held out"), strict=True):
        centres = (np.linspace(a, b, 2 * _BINS + 1)[1::2] for a, b in (extent[:2], extent[2:]))
        one.contour(*centres, density.T, levels=sorted(levels.values()), colors=_VERMILLION, linewidths=1.1)
        one.plot([0], [0], marker=">", color=INK, markersize=6)
        one.set(title=f"displacement in {fitted.step_s:g} s: {name}", xlim=extent[:2], ylim=extent[2:])
        one.set_xlabel("straight on (m)")
    axes[0].set_ylabel("to the left (m)")
    line = Line2D([], [], color=_VERMILLION, linewidth=1.1)
    told = " and ".join(f"{share:.0%}" for share in _LINES)
    axes[0].legend([line], [f"hold {told} of the prediction"], frameon=False, fontsize=7.5, loc="upper left")
    told = " and ".join(f"{share:.0%}" for share in held.values())
    axes[1].legend([line], [f"hold {told} of what people did"], frameon=False, fontsize=7.5, loc="upper left")


def _along_last_move(fitted: FittedMotion) -> Float[np.ndarray, "walking 2"]:
    walks = np.hypot(*fitted.before_m.T) >= fitted.still_mps * fitted.step_s
    (x, y), (ahead, aside) = fitted.after_m[walks].T, fitted.before_m[walks].T / np.hypot(*fitted.before_m[walks].T)
    return np.stack([ahead * x + aside * y, ahead * y - aside * x], axis=1)


def _predicted(fitted: FittedMotion, rng: np.random.Generator) -> Float[np.ndarray, "samples 2"]:
    length = np.hypot(*fitted.before_m.T)
    length = length[length >= fitted.still_mps * fitted.step_s]
    pace = rng.choice(length, _SAMPLES) + rng.normal(0, fitted.sigma_speed_mps * fitted.step_s, _SAMPLES)
    turn = np.radians(rng.normal(0, fitted.sigma_direction_deg, _SAMPLES))
    return np.maximum(pace, 0)[:, None] * np.stack([np.cos(turn), np.sin(turn)], axis=1)


def _density(
    points: Float[np.ndarray, "samples 2"], extent: tuple[float, float, float, float]
) -> Float[np.ndarray, "along aside"]:
    """Share of the points in each bin of the window, smoothed over a bin."""
    from scipy.ndimage import gaussian_filter

    counts = np.histogram2d(points[:, 0], points[:, 1], bins=_BINS, range=[list(extent[:2]), list(extent[2:])])[0]
    return np.asarray(gaussian_filter(counts / len(points), 1.0))


def _level(density: Float[np.ndarray, "along aside"], share: float) -> float:
    """Density above which the bins hold a share of everything."""
    falling = np.sort(density.ravel())[::-1]
    return float(falling[min(int(np.searchsorted(np.cumsum(falling), share)), len(falling) - 1)])


def _share_within(
    points: Float[np.ndarray, "points 2"],
    density: Float[np.ndarray, "along aside"],
    level: float,
    extent: tuple[float, float, float, float],
) -> float:
    low, size = np.array(extent[::2]), np.array([extent[1] - extent[0], extent[3] - extent[2]])
    bins = np.floor((points - low) / size * _BINS).astype(int)
    inside = ((bins >= 0) & (bins < _BINS)).all(axis=1)
    return float((density[tuple(bins[inside].T)] >= level).sum() / len(points))


def _draw_turns(axes: Axes, fitted: FittedMotion) -> None:
    limit = min(180.0, max(4 * fitted.sigma_direction_deg, 20.0))
    edges = np.linspace(-limit, limit, 81)
    axes.hist(fitted.turns_deg, bins=list(edges), density=True, color=_BLUE, alpha=0.45, label="real, held out")
    angles = np.linspace(-limit, limit, 400)
    around = angles[:, None] + 360.0 * np.arange(-4, 5)
    sigma = max(fitted.sigma_direction_deg, 1e-3)
    density = np.exp(-0.5 * (around / sigma) ** 2).sum(axis=1) / (sigma * np.sqrt(2 * np.pi))
    axes.plot(angles, density, color=_VERMILLION, linewidth=1.6, label=f"learned, σ = {sigma:.2f}°")
    axes.set_xlabel("turn in one step (degrees)")
    axes.set_ylabel("density (1/degree)")
    _finish(axes)


def _draw_speeds(axes: Axes, fitted: FittedMotion) -> None:
    limit = float(np.quantile(fitted.speeds_mps, 0.999)) * 1.05 + 0.05
    axes.hist(
        fitted.speeds_mps,
        bins=list(np.linspace(0, limit, 61)),
        density=True,
        color=_BLUE,
        alpha=0.45,
        label="real, held out",
    )
    for number, speed in enumerate(fitted.speed_set_mps):
        label = "learned speeds, ± σ of a step" if number == 0 else None
        axes.axvline(speed, color=_VERMILLION, linewidth=1.6, linestyle=(0, (5, 2)), label=label)
        axes.axvspan(
            max(speed - fitted.sigma_speed_mps, 0), speed + fitted.sigma_speed_mps, color=_VERMILLION, alpha=0.10
        )
    axes.set_xlim(0, limit)
    axes.set_xlabel("speed (m/s)")
    axes.set_ylabel("density (s/m)")
    _finish(axes)


def _finish(axes: Axes) -> None:
    axes.spines[["top", "right"]].set_visible(False)
    axes.set_ylim(0, axes.get_ylim()[1] * 1.25)
    axes.legend(framealpha=1, edgecolor="none", fontsize=7.5, loc="upper right")
