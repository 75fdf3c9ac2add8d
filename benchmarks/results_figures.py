"""Figures of docs/results.md."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from results_table import Results, write_rows

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.estimates import Estimate
from surveillance_domain.experiments.variants import ALL_NAMES
from surveillance_domain.pictures.comparison import Curve, Panel, draw_comparison
from surveillance_domain.pictures.style import save_figure


def draw_figures(results: Results, folder: Path) -> None:
    """``comparison-<truth>`` as PNG and SVG, ``means.csv`` and ``differences.csv``."""
    for truth in results.truths:
        sites = dict.fromkeys(site for kind, site, _ in results.panels if kind == truth)
        panels = [_panel(results, truth, site, COMPARED) for site in sites]
        note = (
            f"{results.runs} runs of {results.steps} steps, seed {results.seed}; bands: 95 % confidence; grey: bounds"
        )
        save_figure(
            draw_comparison(panels, f"Targets observed, {truth} truth", note), folder / f"comparison-{truth}.png"
        )
    means = [(*panel, name, results.mean(*panel, name)) for panel in results.panels for name in COMPARED]
    leads = [(*panel, name, results.lead(*panel, name)) for panel in results.panels for name in COMPARED[1:]]
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


def _write(path: Path, rows: Sequence[tuple[str, str, int, str, Estimate]]) -> None:
    heads = ["truth", "site", "targets", "controller", "mean", "low", "high", "runs"]
    made = []
    for *case, found in rows:
        numbers = [f"{n:.4f}" if math.isfinite(n) else "" for n in (found.mean, found.low, found.high)]
        made.append([*case, *numbers, len(found.samples)])
    write_rows(path, heads, made)
