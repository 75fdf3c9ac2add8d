"""Figures of docs/results-sensitivity.md: the lead of P over each rival against a parameter, and against κ."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from results_sensitivity import PARAMETERS, Parameter, Slices, places
from results_table import Results

from surveillance_domain.experiments.variants import ALL_NAMES
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, save_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, VERMILLION, GREEN, PINK, _, ORANGE = CAMERA_COLOURS
ROWS = (("mp", "sys", "stat"), ("msp", "full-information"))
"""Rivals far below P; those near to it, on a scale of their own."""
LOOKS = {
    "mp": (VERMILLION, "s"),
    "sys": (PINK, "D"),
    "stat": (ORANGE, "v"),
    "msp": (GREEN, "^"),
    "full-information": ("#6b6b6b", "_"),
}


def draw_sensitivity(comparison: Results, slices: Slices, folder: Path) -> None:
    """``sensitivity-<parameter>`` and ``kappa``, as PNG and SVG."""
    for parameter in PARAMETERS:
        save_figure(_draw_parameter(parameter, slices), folder / f"sensitivity-{parameter.name}.png")
    save_figure(_draw_kappa(comparison), folder / "kappa.png")


@styled
def _draw_parameter(parameter: Parameter, slices: Slices) -> Figure:
    """Above: the rivals that P leads by far; below: those that are near. A column for each site."""
    sites, counts = (list(dict.fromkeys(one)) for one in zip(*places(slices), strict=True))
    figure = new_figure(3.4 * len(sites), 5.6)
    all_axes = figure.subplots(2, len(sites), sharex=True, sharey="row", squeeze=False)
    for row, names in zip(all_axes, ROWS, strict=True):
        for axes, site in zip(row, sites, strict=True):
            for name in names:
                for count in counts:
                    _draw_lead(axes, parameter, slices, site, count, name, count == counts[0])
            axes.axhline(0, color=INK, linewidth=0.8)
            axes.set_xticks(range(len(parameter.values)), labels=parameter.values)
            axes.set_xlim(-0.4, len(parameter.values) - 0.6)
            axes.spines[["top", "right"]].set_visible(False)
        row[0].set_ylabel("P − other (points)")
    for axes, site in zip(all_axes[0], sites, strict=True):
        axes.set_title(site, fontsize=10, fontweight="bold")
    for axes in all_axes[1]:
        axes.set_xlabel(parameter.title)
    handles = [axes.get_legend_handles_labels() for axes in all_axes[:, 0]]
    figure.legend(
        [handle for of, _ in handles for handle in of],
        [label for _, of in handles for label in of],
        loc="outside lower center",
        ncols=5,
        frameon=False,
        fontsize=8,
    )
    own = f"; own value of the sites: {parameter.own}" if parameter.own else ""
    figure.suptitle(f"Above zero P observes more; bars: 95 %{own}")
    return figure


def _draw_lead(axes: Any, parameter: Parameter, slices: Slices, site: str, count: int, other: str, few: bool) -> None:
    """Few targets: a full line and full marks; many: dashed and hollow."""
    colour, marker = LOOKS[other]
    found = [slices[parameter.name, value].lead("grid", site, count, other) for value in parameter.values]
    shift = -0.06 if few else 0.06
    axes.errorbar(
        [place + shift for place in range(len(found))],
        [one.mean for one in found],
        yerr=[one.half_width for one in found],
        color=colour,
        marker=marker,
        linestyle="-" if few else "--",
        markerfacecolor=colour if few else "white",
        markersize=5,
        linewidth=1.2,
        label=f"{ALL_NAMES[other]}, m = {count}",
    )


@styled
def _draw_kappa(results: Results) -> Figure:
    """P − MSP against the noise of MSP's static cameras."""
    sites = list(dict.fromkeys(site for _, site, _ in results.panels))
    kappas = results.kappas
    tried = sorted({(truth, count) for truth, _, count in results.with_runs_of("msp", kappas[0])})
    looks = dict(
        zip(tried, zip(CAMERA_COLOURS, ("-", "--", "-.", ":"), ("o", "s", "^", "D"), strict=False), strict=False)
    )
    figure = new_figure(3.4 * len(sites), 3.6)
    all_axes = figure.subplots(1, len(sites), sharey=True, squeeze=False)[0]
    places = range(len(kappas))
    for axes, site in zip(all_axes, sites, strict=True):
        for truth, count in tried:
            colour, line, marker = looks[truth, count]
            found = [results.lead(truth, site, count, "msp", kappa) for kappa in kappas]
            label = f"m = {count}, {truth} truth"
            axes.plot(places, [e.mean for e in found], color=colour, linestyle=line, marker=marker, ms=4, label=label)
            bounds = ([e.low for e in found], [e.high for e in found])
            axes.fill_between(places, *bounds, color=colour, alpha=0.15, linewidth=0)
        axes.axhline(0, color=INK, linewidth=0.8)
        axes.set_xticks(places, labels=kappas)
        axes.set_xlabel("κ of the static cameras (m of σ a metre)")
        axes.set_title(site, fontsize=10, fontweight="bold")
        axes.spines[["top", "right"]].set_visible(False)
    all_axes[0].set_ylabel("P − MSP (points of PercentObs)")
    handles, labels = all_axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, frameon=False, fontsize=8)
    figure.suptitle("Where the ranking of P and MSP turns; above zero P observes more")
    return figure
