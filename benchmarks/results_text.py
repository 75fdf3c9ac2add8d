"""The words of docs/results.md; every figure and every verdict in it is worked out from the runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from results_table import Panel, Results
from results_words import fill, judged_at, made_by, signed, spans, table, unsigned, words

from surveillance_domain.control.factory import COMPARED
from surveillance_domain.experiments.estimates import Estimate
from surveillance_domain.experiments.setup import Setup, site_of
from surveillance_domain.experiments.variants import ALL_NAMES
from surveillance_domain.model.views import static_views

BASELINES = ("mp", "msp", "sys", "stat")
BOUNDS = ("full-information", "clairvoyant")
FULL_RUNS = 50
SHOWN = (1, 2, 5, 10, 15, 20)
"""Numbers of targets with rows in the long tables; figures, files and verdicts have all of them."""

_RANKING = """## Which rankings hold

The paper says that P observes more than MP, MSP, Sys and Stat in all setups. *Holds*: the whole interval of the paired
difference lies above zero; **fails**: below; *undecided*: it holds zero. A panel is a site with a number of targets
under a kind of truth. Each interval stands for itself: one in twenty misses, and none is widened for their number.
"""
_WHY = ("floor in static view", "σ there, mean (m)", "cell (m)", "P knows", "MSP knows", "MP knows")
_KNOWS = """*Knows*: share of target-steps (m = 5) at which the target is placed within one cell of where it is; for P
the mass of its belief there after the sighting, for MSP and MP whether this step's sighting, static or PTZ, lies
there."""
_STARTED_ANEW = """How often a sighting was impossible for P's belief, per 1000 target-steps. Under grid truth it cannot
happen; under continuous truth it measures the misfit of the grid."""


def page(results: Results) -> str:
    """The whole page."""
    parts = [
        _opening(results),
        _ranking(results),
        _why_msp(results),
        _bounds(results),
        _means(results),
        _differences(results),
        _restarts(results),
    ]
    return "\n\n".join(parts) + "\n"


def _opening(results: Results) -> str:
    counts = spans(sorted({panel[2] for panel in results.panels}))
    text = f"""{made_by(results.runs, FULL_RUNS, results.seed)}: {results.runs} runs of {results.steps} steps for each
controller, site, number of targets ({counts}) and kind of truth, seed {results.seed}; run r is the same world for every
controller. PercentObs is the paper's measure (sec. expdis). Intervals are Student's 95 % intervals over runs; those
of differences are paired, run by run. Camera poses, σ₀ and κ stand in the built-in site files, fixed and justified
there before any controller was run. Under *grid* truth targets move by the model's own chain; under *continuous*
truth they move in metres, as in the paper's simulator, and the belief stays on the grid. The paper's own curves are
not printed as numbers, so nothing here is set beside them. Every run stands in [runs.csv](figures/runs.csv); means
in [means.csv](figures/means.csv), paired differences in [differences.csv](figures/differences.csv); the long tables
below show m = {words(map(str, SHOWN))}."""
    more = """What walls, σ, the depth of view, the noise of static cameras and the memory of MP change is on a
page of its own, [sensitivity](results-sensitivity.md); the same controllers against recorded people on
[another](results-people.md)."""
    pictures = [f"![PercentObs, {truth} truth](figures/comparison-{truth}.png)" for truth in results.truths]
    return "\n\n".join(["# Results", fill(text), fill(more), *pictures])


def _ranking(results: Results) -> str:
    """The paper's claim, P above MP, MSP, Sys and Stat, panel by panel."""
    lines = [_RANKING]
    for name in BASELINES:
        leads = {panel: results.lead(*panel, name) for panel in results.panels}
        lines.append(f"- {_claim(ALL_NAMES[name], leads)}")
    lines.append("")

    rows = []
    for truth, site in dict.fromkeys(panel[:2] for panel in results.panels):
        counts = [count for *place, count in results.panels if place == [truth, site]]
        leads_of = ({m: results.lead(truth, site, m, name) for m in counts} for name in BASELINES)
        rows.append([truth, site, *map(judged_at, leads_of)])
    heads = [f"P > {ALL_NAMES[name]}" for name in BASELINES]
    return "\n".join([*lines, table(["truth", "site", *heads], rows, len(heads) + 2)])


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
    rows: list[list[str]] = []
    known: list[tuple[float, float]] = []
    for truth, name in dict.fromkeys(panel[:2] for panel in results.panels):
        site = site_of(Setup(name, 1))
        centres = site.grid.centres_m
        noise = [c.noise_m[0] + c.noise_m[1] * np.hypot(*(centres - c.position_m[:2]).T) for c in site.static_cameras]
        best = np.where(static_views(site), noise, np.inf).min(axis=0)
        seen = np.isfinite(best)
        shares = [
            results.mean(truth, name, 5, controller, kappa, "known").mean
            for controller, kappa in (("pomdp", ""), ("msp", f"{site.static_cameras[0].noise_m[1]:g}"), ("mp", ""))
        ]
        known.append((shares[0], shares[1]))
        numbers = [f"{seen.mean():.0%}", f"{best[seen].mean():.2f}", f"{site.grid.cell_m:g}"]
        rows.append([truth, name, *numbers, *(f"{share:.0f} %" for share in shares)])
    made = table(["truth", "site", *_WHY], rows, 2)
    return "\n\n".join(["## Why MSP is so near to P", made, _KNOWS, _because(results, *np.mean(known, axis=0))])


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
            it does not print; [sensitivity](results-sensitivity.md) shows where the ranking turns.""",
        )
    )


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
        for name in COMPARED
        for bound, value in zip(
            _ordered(results.samples(*panel, "clairvoyant")), _ordered(results.samples(*panel, name)), strict=True
        )
        if name != "clairvoyant"
    ]
    return min(differences), len(differences)


def _means(results: Results) -> str:
    def cell(truth: str, site: str, count: int, name: str) -> str:
        return unsigned(results.mean(truth, site, count, name))

    return "## PercentObs\n\n" + _per_panel(results, [ALL_NAMES[name] for name in COMPARED], COMPARED, cell)


def _differences(results: Results) -> str:
    others = [name for name in COMPARED if name != "pomdp"]

    def cell(truth: str, site: str, count: int, name: str) -> str:
        return signed(results.lead(truth, site, count, name))

    heads = [ALL_NAMES[name] for name in others]
    return "## Paired differences: P minus the other\n\n" + _per_panel(results, heads, others, cell)


def _restarts(results: Results) -> str:
    rows = [
        [site, count, *(f"{results.restarts_per_thousand(truth, site, count):.2f}" for truth in results.truths)]
        for site, count in dict.fromkeys(panel[1:] for panel in results.panels)
        if count in SHOWN
    ]
    made = table(["site", "m", *results.truths], rows, 1)
    return "\n\n".join(["## Beliefs that had to be started anew", _STARTED_ANEW, made])


def _per_panel(
    results: Results, heads: Sequence[str], names: Sequence[str], cell: Callable[[str, str, int, str], str]
) -> str:
    """A row for each panel that is shown, a column for each controller."""
    rows = [[*panel, *(cell(*panel, name) for name in names)] for panel in results.panels if panel[2] in SHOWN]
    return table(["truth", "site", "m", *heads], rows, 2)


def _ordered(samples: dict[int, float]) -> list[float]:
    return [samples[run] for run in sorted(samples)]
