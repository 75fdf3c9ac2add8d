"""Figures of docs/results.md."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from results_table import SIMULATED, Results

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.estimates import Estimate
from surveillance_domain.experiments.variants import ALL_NAMES
from surveillance_domain.pictures.comparison import Curve, Panel, draw_comparison
from surveillance_domain.pictures.style import CAMERA_COLOURS, INK, new_figure, save_figure, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def draw_figures(results: Results, folder: Path) -> None:
    """``comparison-<truth>`` and ``kappa`` as PNG and SVG, ``means.csv`` and ``differences.csv``."""
    for truth in results.truths:
        sites = dict.fromkeys(site for kind, site, _ in results.panels if kind == truth)
        panels = [_panel(results, truth, site, COMPARED) for site in sites]
        note = (
            f"{results.runs} runs of {results.steps} steps, seed {results.seed}; bands: 95 % confidence; grey: bounds"
        )
        save_figure(
            draw_comparison(panels, f"Targets observed, {truth} truth", note), folder / f"comparison-{truth}.png"
        )
    save_figure(_draw_kappa(results), folder / "kappa.png")
    means = [(t, s, m, c, results.mean(t, s, m, c)) for t, s, m in results.panels for c in SIMULATED]
    leads = [(t, s, m, c, results.lead(t, s, m, c)) for t, s, m in results.panels for c in SIMULATED if c != "pomdp"]
    _write(folder / "means.csv", means)
    _write(folder / "differences.csv", leads)


def _panel(results: Results, truth: str, site: str, controllers: Sequence[str]) -> Panel:
    counts = tuple(sorted(m for t, s, m in results.panels if (t, s) == (truth, site)))
    curves = []
    for name in controllers:
        found = [results.mean(truth, site, m, name) for m in counts]
        ends = (tuple(e.mean for e in found), tuple(e.low for e in found), tuple(e.high for e in found))
        curves.append(Curve(name, ALL_NAMES[name], counts, *ends))
    return Panel(site, tuple(curves))


@styled
def _draw_kappa(results: Results) -> Figure:
    """P − MSP against the noise of MSP's static cameras."""
    sites = list(dict.fromkeys(site for _, site, _ in results.panels))
    kappas = results.kappas
    tried = sorted({(case[1], case[3]) for case in results.percent if case[0] == "percent-obs" and case[5]})
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


def _write(path: Path, rows: Sequence[tuple[str, str, int, str, Estimate]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["truth", "site", "targets", "controller", "mean", "low", "high", "runs"])
        for *case, found in rows:
            numbers = [f"{n:.4f}" if math.isfinite(n) else "" for n in (found.mean, found.low, found.high)]
            writer.writerow([*case, *numbers, len(found.samples)])
