"""The section of docs/results-sensitivity.md on the noise of the static cameras."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from results_plan import KNOWN_COUNT
from results_table import Results
from results_words import fill, signed, table

_INTRODUCED = """P − MSP in points, for σ = σ₀ + κ · distance with the site's σ₀ and another κ for all static cameras of
the site ({runs} runs). *Turns*: where the mean difference crosses zero, by linear interpolation."""


def kappa_section(results: Results) -> str:
    """P − MSP against κ, where it turns, and what MSP knows."""
    kappas = results.kappas
    rows = []
    for panel in results.with_runs_of("msp", kappas[0]):
        leads = [results.lead(*panel, "msp", kappa) for kappa in kappas]
        rows.append([*panel, *map(signed, leads), _turn([float(kappa) for kappa in kappas], [e.mean for e in leads])])
    heads = [f"κ = {kappa}" for kappa in kappas]
    known = []
    for truth, site in dict.fromkeys(panel[:2] for panel in results.panels):
        cases = [("msp", kappa) for kappa in kappas] + [("pomdp", "")]
        shares = [results.mean(truth, site, KNOWN_COUNT, *case, what="known").mean for case in cases]
        known.append([truth, site, *(f"{share:.0f} %" for share in shares)])
    runs = len(results.samples(*results.with_runs_of("msp", kappas[0])[0], "msp", kappas[0]))
    parts = [
        "## Noise of the static cameras",
        fill(_INTRODUCED.format(runs=runs)),
        "![P − MSP against κ](figures/kappa.png)",
        table(["truth", "site", "m", *heads, "turns at κ ≈"], rows, 2),
        fill(f"Share of target-steps at which MSP knows where a target is (m = {KNOWN_COUNT}), with P's beside it:"),
        table(["truth", "site", *heads, "P"], known, 2),
    ]
    return "\n\n".join(parts)


def _turn(kappas: Sequence[float], leads: Sequence[float]) -> str:
    if leads[0] > 0:
        return f"below {kappas[0]:g}"
    for (left, low), (right, high) in pairwise(zip(kappas, leads, strict=True)):
        if low <= 0 < high:
            return f"{left + (right - left) * -low / (high - low):.2f}"
    return f"above {kappas[-1]:g}"
