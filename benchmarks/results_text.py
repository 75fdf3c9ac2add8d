"""The words of docs/results.md; every figure and every verdict in it is worked out from the runs."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise

import numpy as np
from results_table import Panel, Results

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.estimates import Estimate
from surveillance_domain.experiments.setup import Setup, site_of
from surveillance_domain.experiments.variants import ALL_NAMES
from surveillance_domain.model.views import static_views

BASELINES = ("mp", "msp", "sys", "stat")
BOUNDS = ("full-information", "clairvoyant")
OUT_OF_SIGHT = {"mp": "dropped", "mp-hold": "held where last seen", "mp-dead-reckoning": "dead reckoning"}
KEPT = ("mp-hold", "mp-dead-reckoning")
VERDICTS = {1: "holds", 0: "undecided", -1: "**fails**"}


_RANKING = """## Which rankings hold

The paper says that P observes more than MP, MSP, Sys and Stat in all setups. *Holds*: the whole interval of the paired
difference lies above zero; **fails**: below; *undecided*: it holds zero. A panel is a site with a number of targets
under a kind of truth.
"""
_KNOWS = """*Knows*: share of target-steps (m = 5) at which the target is placed within one cell of where it is; for P
the mass of its belief there after the sighting, for MSP and MP whether this step's sighting, static or PTZ, lies
there."""
_SENSITIVITY = """## Sensitivity: noise of the static cameras

![P − MSP against κ](figures/kappa.png)

P − MSP in points, for σ = σ₀ + κ · distance with the site's σ₀ and another κ for all static cameras of the site.
*Turns*: where the mean difference crosses zero, by linear interpolation."""
_STARTED_ANEW = """How often a sighting was impossible for P's belief, per 1000 target-steps. Under grid truth it cannot
happen; under continuous truth it measures the misfit of the grid."""


def fill(text: str) -> str:
    """A paragraph in lines of equal length."""
    return textwrap.fill(" ".join(text.split()), 118, break_long_words=False, break_on_hyphens=False)


def page(results: Results, command: str) -> str:
    """The whole page."""
    parts = [
        _opening(results, command),
        _ranking(results),
        _why_msp(results),
        _kappa(results),
        _bounds(results),
        _means(results),
        _differences(results),
        _variants(results),
        _restarts(results),
    ]
    return "\n\n".join(parts) + "\n"


def _opening(results: Results, command: str) -> str:
    counts = _words(str(m) for m in dict.fromkeys(panel[2] for panel in results.panels))
    text = f"""Made by `make results` (`{command}`): {results.runs} runs of {results.steps} steps for each controller,
site, number of targets ({counts}) and kind of truth, seed {results.seed}; run r is the same world for every
controller. PercentObs is the paper's measure (sec. expdis). Intervals are Student's 95 % intervals over runs; those
of differences are paired, run by run. Camera poses, σ₀ and κ stand in the built-in site files, fixed and justified
there before any controller was run. Under *grid* truth targets move by the model's own chain; under *continuous*
truth they move in metres, as in the paper's simulator, and the belief stays on the grid. The paper's own curves are
not printed as numbers, so nothing here is set beside them. Every run stands in [runs.csv](figures/runs.csv); means
in [means.csv](figures/means.csv), paired differences in [differences.csv](figures/differences.csv)."""
    pictures = [f"![PercentObs, {truth} truth](figures/comparison-{truth}.png)" for truth in results.truths]
    return "\n\n".join(["# Results", fill(text), *pictures])


def _ranking(results: Results) -> str:
    """The paper's claim, P above MP, MSP, Sys and Stat, panel by panel."""
    lines = [_RANKING]
    for name in BASELINES:
        leads = {panel: results.lead(*panel, name) for panel in results.panels}
        lines.append(f"- {_claim(ALL_NAMES[name], leads)}")
    lines.append("")

    def verdict(truth: str, site: str, count: int, name: str) -> str:
        found = results.lead(truth, site, count, name)
        return f"{VERDICTS[found.verdict]} ({found.mean:+.1f})"

    lines += _table(results, [f"P > {ALL_NAMES[name]}" for name in BASELINES], BASELINES, verdict)
    return "\n".join(lines)


def _claim(name: str, leads: dict[Panel, Estimate]) -> str:
    """In how many panels the claim holds, and at which sites it does not."""
    margins = [lead.mean for lead in leads.values()]
    said = f"P above {name}: holds in {sum(lead.verdict > 0 for lead in leads.values())} of {len(leads)} panels"
    for verdict, word in ((-1, "fails in"), (0, "is undecided in")):
        sites = [site for (_, site, _), lead in leads.items() if lead.verdict == verdict]
        if sites:
            counted = ", ".join(f"{site} {sites.count(site)}" for site in dict.fromkeys(sites))
            said += f", {word} {len(sites)} ({counted})"
    return f"{said}; P − {name} is {min(margins):+.1f} to {max(margins):+.1f} points."


def _why_msp(results: Results) -> str:
    """How much of the truth each controller knows, before it chooses anything."""
    lines = ["## Why MSP is so near to P", ""]
    heads = [
        "truth",
        "site",
        "floor in static view",
        "σ there, mean (m)",
        "cell (m)",
        "P knows",
        "MSP knows",
        "MP knows",
    ]
    lines += ["| " + " | ".join(heads) + " |", "|---|---|" + "---:|" * (len(heads) - 2)]
    known: list[tuple[float, float]] = []
    for truth, name in dict.fromkeys(panel[:2] for panel in results.panels):
        site = site_of(Setup(name, 1))
        seen = static_views(site)
        sigma = np.array(
            [
                c.noise_m[0] + c.noise_m[1] * np.hypot(*(site.grid.centres_m - c.position_m[:2]).T)
                for c in site.static_cameras
            ]
        )
        best = np.where(seen, sigma, np.inf).min(axis=0)
        shares = [
            results.mean(truth, name, 5, controller, kappa, "known").mean
            for controller, kappa in (("pomdp", ""), ("msp", f"{site.static_cameras[0].noise_m[1]:g}"), ("mp", ""))
        ]
        known.append((shares[0], shares[1]))
        numbers = [f"{np.isfinite(best).mean():.0%}", f"{best[np.isfinite(best)].mean():.2f}", f"{site.grid.cell_m:g}"]
        lines.append("| " + " | ".join([truth, name, *numbers, *(f"{share:.0f} %" for share in shares)]) + " |")
    lines += ["", _KNOWS, "", _because(results, *np.mean(known, axis=0))]
    return "\n".join(lines)


def _because(results: Results, ours: float, theirs: float) -> str:
    """The reason for the ranking of P and MSP, in numbers."""
    names = ("full-information", "msp", "mp")
    gain = {name: [-results.lead(*panel, name).mean for panel in results.panels] for name in names}
    span = {name: f"{min(of):+.1f} to {max(of):+.1f}" for name, of in gain.items()}
    worth = {name: f"{span[name]} points (mean {np.mean(gain[name]):+.1f})" for name in names}
    if theirs <= ours:
        return fill(
            f"""P knows {ours:.0f} % on average, MSP {theirs:.0f} %: the noise of the static cameras costs MSP more than
            what they see brings in. Against P, full information is worth {worth["full-information"]}, MSP
            {worth["msp"]}, MP {worth["mp"]}."""
        )
    return "\n\n".join(
        fill(text)
        for text in (
            f"""P knows {ours:.0f} % on average, MSP {theirs:.0f} %. MSP's wide-view cameras report every target that
            they see at every step, mostly with an error of less than a cell, so that MSP decides on nearly full
            information; P has only its PTZ cameras and infers where the others went.""",
            f"""Nearly full information is not worth much here: full information itself gains
            {worth["full-information"]} over P. MSP gains {worth["msp"]}, MP {worth["mp"]}. So P comes close, without
            static cameras, to what a controller of this kind can reach, but it does not pass one that has static
            cameras which see well. The paper's ranking of P above MSP rests on the noise of its static cameras, which
            it does not print; the next section shows where the ranking turns.""",
        )
    )


def _kappa(results: Results) -> str:
    """P − MSP against κ, and where it turns."""
    kappas = results.kappas
    lines = [_SENSITIVITY]
    heads = ["truth", "site", "m", *(f"κ = {kappa}" for kappa in kappas), "turns at κ ≈"]
    lines += ["", "| " + " | ".join(heads) + " |", "|---|---|" + "---:|" * (len(heads) - 2)]
    for truth, site, count in results.panels:
        if ("percent-obs", truth, site, count, "msp", kappas[0]) not in results.percent:
            continue
        leads = [results.lead(truth, site, count, "msp", kappa) for kappa in kappas]
        turn = _turn([float(kappa) for kappa in kappas], [lead.mean for lead in leads])
        lines.append("| " + " | ".join([truth, site, str(count), *map(_signed, leads), turn]) + " |")
    lines += ["", "MSP knows (as above, m = 5), with P's share beside it:", ""]
    lines += ["| truth | site | " + " | ".join(f"κ = {kappa}" for kappa in kappas) + " | P |"]
    lines += ["|---|---|" + "---:|" * (len(kappas) + 1)]
    for truth, site in dict.fromkeys(panel[:2] for panel in results.panels):
        shares = [results.mean(truth, site, 5, "msp", kappa, "known").mean for kappa in kappas]
        shares.append(results.mean(truth, site, 5, "pomdp", "", "known").mean)
        lines.append("| " + " | ".join([truth, site, *(f"{share:.0f} %" for share in shares)]) + " |")
    return "\n".join(lines)


def _turn(kappas: Sequence[float], leads: Sequence[float]) -> str:
    if leads[0] > 0:
        return f"below {kappas[0]:g}"
    for (left, low), (right, high) in pairwise(zip(kappas, leads, strict=True)):
        if low <= 0 < high:
            return f"{left + (right - left) * -low / (high - low):.2f}"
    return f"above {kappas[-1]:g}"


def _bounds(results: Results) -> str:
    """Whether the bounds bound."""
    lines = ["## The bounds", ""]
    for name in BOUNDS:
        leads = {panel: results.lead(*panel, name) for panel in results.panels}
        above = sum(lead.verdict < 0 for lead in leads.values())
        below = [panel for panel, lead in leads.items() if lead.verdict > 0]
        gaps = [-lead.mean for lead in leads.values()]
        said = f"- {ALL_NAMES[name]} − P: {min(gaps):.1f} to {max(gaps):.1f} points; the interval lies above zero in "
        said += f"{above} of {len(leads)} panels"
        said += f", **below zero at {below}**." if below else ", below zero in none."
        lines.append(said)
    worst, count = _against_clairvoyant(results)
    lines.append(
        f"- clairvoyant against every other controller, run by run ({count:,} pairs): the smallest difference is "
        f"{worst:.2f} points" + ("." if worst >= -1e-9 else "; **a bound is broken**.")
    )
    return "\n".join(lines)


def _against_clairvoyant(results: Results) -> tuple[float, int]:
    differences = [
        bound - value
        for panel in results.panels
        for name in (*COMPARED, *OUT_OF_SIGHT)
        for bound, value in zip(
            _ordered(results.samples(*panel, "clairvoyant")), _ordered(results.samples(*panel, name)), strict=True
        )
        if name != "clairvoyant"
    ]
    return min(differences), len(differences)


def _means(results: Results) -> str:
    lines = ["## PercentObs", ""]

    def cell(truth: str, site: str, count: int, name: str) -> str:
        found = results.mean(truth, site, count, name)
        return f"{found.mean:.1f} ± {found.half_width:.1f}"

    return "\n".join(lines + _table(results, [ALL_NAMES[name] for name in COMPARED], COMPARED, cell))


def _differences(results: Results) -> str:
    others = [name for name in COMPARED if name != "pomdp"]
    lines = ["## Paired differences: P minus the other", ""]

    def cell(truth: str, site: str, count: int, name: str) -> str:
        return _signed(results.lead(truth, site, count, name))

    return "\n".join(lines + _table(results, [ALL_NAMES[name] for name in others], others, cell))


def _variants(results: Results) -> str:
    lines = ["## Sensitivity: what MP does with a target out of sight", ""]
    kept = [results.lead(*panel, "mp").mean - results.lead(*panel, n).mean for panel in results.panels for n in KEPT]
    worst, best = min(kept), max(kept)
    ahead = [results.lead(*panel, name) for panel in results.panels for name in OUT_OF_SIGHT]
    sure = sum(lead.verdict > 0 for lead in ahead)
    said = f"""P minus the variant. Keeping targets in mind changes MP by {worst:+.1f} to {best:+.1f} points; the
    interval of P minus the variant lies above zero in {sure} of {len(ahead)} cases."""
    lines.append(fill(said))
    lines.append("")

    def cell(truth: str, site: str, count: int, name: str) -> str:
        return _signed(results.lead(truth, site, count, name))

    return "\n".join(lines + _table(results, list(OUT_OF_SIGHT.values()), list(OUT_OF_SIGHT), cell))


def _restarts(results: Results) -> str:
    lines = ["## Beliefs that had to be started anew", ""]
    lines.append(_STARTED_ANEW)
    truths = results.truths
    lines += ["", "| site | m | " + " | ".join(truths) + " |", "|---|---:|" + "---:|" * len(truths)]
    for site, count in dict.fromkeys(panel[1:] for panel in results.panels):
        rates = [f"{results.restarts_per_thousand(truth, site, count):.2f}" for truth in truths]
        lines.append("| " + " | ".join([site, str(count), *rates]) + " |")
    return "\n".join(lines)


def _table(
    results: Results, heads: Sequence[str], names: Sequence[str], cell: Callable[[str, str, int, str], str]
) -> list[str]:
    """A row for each panel, a column for each controller."""
    lines = ["| truth | site | m | " + " | ".join(heads) + " |", "|---|---|---:|" + "---:|" * len(heads)]
    for panel in results.panels:
        cells = [cell(*panel, name) for name in names]
        lines.append("| " + " | ".join([*map(str, panel), *cells]) + " |")
    return lines


def _signed(found: Estimate) -> str:
    return f"{found.mean:+.1f} ± {found.half_width:.1f}"


def _ordered(samples: dict[int, float]) -> list[float]:
    return [samples[run] for run in sorted(samples)]


def _words(words: Iterable[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
