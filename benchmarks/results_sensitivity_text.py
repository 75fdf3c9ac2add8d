"""The words of docs/results-sensitivity.md; every figure and every verdict in it is worked out from the runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
from results_kappa_text import kappa_section
from results_plan import KNOWN_COUNT, OUT_OF_SIGHT
from results_runs import UNAWARE
from results_sensitivity import AGAINST, MISLED, PARAMETERS, Parameter, Slices, places
from results_table import Panel, Results
from results_words import fill, judged, made_by, signed, table, words

from surveillance_domain.experiments.estimates import Estimate
from surveillance_domain.experiments.variants import ALL_NAMES

FULL_RUNS = 20
INTRODUCED = {
    "walls": """The paper does not say what becomes of a move that ends in a wall. *reject*: the rest of the moves is
        renormalised; *reflect*: mirrored like a ball; *stay*: the target stops before the wall.""",
    "sigma-direction": """By how much a target's direction changes from step to step. The site files say 30°, a guess
        for people who cross a hall without hurry; the smaller it is, the further ahead a belief can see.""",
    "sigma-speed": """With one speed, as in the paper, σ of the speed means nothing. Here targets have three, 1, 1.5 and
        2 m/s, and change from one to another with this σ; at 0 each keeps its own, which nobody knows beforehand.""",
    "depth": """How far a camera sees well enough. The depth is scaled by way of the pixels per metre that are required:
        5.4, 7.2 and 9.0 m in hall and corridor, 6.5, 8.6 and 10.8 m in the junction. Poses and presets stay.""",
}


def page(comparison: Results, slices: Slices) -> str:
    """The whole page."""
    parts = [_opening(slices), _flips(slices)]
    parts += [_section(parameter, slices) for parameter in PARAMETERS]
    parts += [kappa_section(comparison), _out_of_sight(comparison)]
    return "\n\n".join(parts) + "\n"


def _opening(slices: Slices) -> str:
    first = next(iter(slices.values()))
    counts = words(dict.fromkeys(str(count) for _, count in places(slices)))
    text = f"""{made_by(first.runs, FULL_RUNS, first.seed)}: {first.runs} runs of {first.steps} steps a point, seed
    {first.seed}, with {counts} targets, on the worlds of the [results](results.md). One parameter
    is changed at a time; grid truth, unless a table says otherwise. Targets move by what the belief holds, so the
    problem changes and the model stays right, except where a controller is *unaware* of the change. Differences are
    paired, run by run, with 95 % intervals. Every run stands in [sensitivity.csv](figures/sensitivity.csv)."""
    return f"# Sensitivity\n\n{fill(text)}"


def _flips(slices: Slices) -> str:
    """The rankings that are not everywhere what they are at the sites' own values, and why."""
    lines = ["## What turns over", ""]
    for parameter in PARAMETERS:
        for other in AGAINST:
            for site, count in places(slices):
                leads = {value: _lead(slices, parameter, value, site, count, other) for value in parameter.values}
                if len({lead.verdict for lead in leads.values()} - {0}) > 1:
                    told = ", ".join(f"{value}: {signed(lead)}" for value, lead in leads.items())
                    why = _reason(slices, parameter, site, leads) if other == "msp" else "why is not known"
                    lines.append(f"- {parameter.title}, {site}, m = {count}: P − {ALL_NAMES[other]} is {told}; {why}.")
    if len(lines) == 2:
        lines.append("Nothing: no ranking of P that is beyond doubt at one value is reversed beyond doubt at another.")
    lines += ["", fill(_held(slices))]
    return "\n".join(lines)


def _reason(slices: Slices, parameter: Parameter, site: str, leads: Mapping[str, Estimate]) -> str:
    """Whether the lead over MSP goes with what P knows and MSP does not."""
    least, most = (pick(leads, key=lambda value: leads[value].mean) for pick in (min, max))
    (ours, theirs), (ours_after, theirs_after) = (_knows(slices, parameter, value, site) for value in (least, most))
    shares = f"P knows {ours:.0f} → {ours_after:.0f} %, MSP {theirs:.0f} → {theirs_after:.0f} %"
    told = f"m = {KNOWN_COUNT}: from {least} to {most} {shares}"
    if ours_after - theirs_after > ours - theirs:
        return f"it goes with what they know ({told})"
    return f"what they know does not explain it ({told}), and why is not known"


def _held(slices: Slices) -> str:
    """How often P is above each of the others, over all values and places."""
    said = []
    for other in AGAINST[:-1]:
        leads = [
            _lead(slices, parameter, value, site, count, other)
            for parameter in PARAMETERS
            for value in parameter.values
            for site, count in places(slices)
        ]
        holds, fails = (sum(lead.verdict == sign for lead in leads) for sign in (1, -1))
        least, most = min(lead.mean for lead in leads), max(lead.mean for lead in leads)
        said.append(
            f"P above {ALL_NAMES[other]} holds in {holds} of {len(leads)} cases and fails in {fails} "
            f"({least:+.1f} to {most:+.1f} points)"
        )
    return f"Over all values of the four parameters below: {'; '.join(said)}."


def _section(parameter: Parameter, slices: Slices) -> str:
    """One parameter: its picture and its differences."""
    names = [ALL_NAMES[name] for name in AGAINST]
    rows = []
    for site, count in places(slices):
        for value in parameter.values:
            ours = slices[parameter.name, value].mean("grid", site, count, "pomdp")
            leads = [_lead(slices, parameter, value, site, count, other) for other in AGAINST]
            shares = [f"{share:.0f} %" for share in _knows(slices, parameter, value, site)]
            shown = value + (" (own)" if value == parameter.own else "")
            rows.append([site, count, shown, f"{ours.mean:.1f}", *map(signed, leads), *shares])
    heads = ["site", "m", parameter.name, "P", *(f"P − {name}" for name in names), "P knows", "MSP knows"]
    made = table(heads, rows, 1)
    title = parameter.title if parameter.title.startswith("σ") else parameter.title.capitalize()
    picture = f"![{parameter.title}: P minus the others](figures/sensitivity-{parameter.name}.png)"
    known = fill(
        f"""*Knows*: as in the [results](results.md#why-msp-is-so-near-to-p), with {KNOWN_COUNT} targets; own: the value
        of the site files."""
    )
    parts = [f"## {title}", fill(INTRODUCED[parameter.name]), picture, made, known]
    return "\n\n".join([*parts, *(_misled(parameter, slices) if parameter.misfit else ())])


def _misled(parameter: Parameter, slices: Slices) -> Iterator[str]:
    """Targets that move as the belief does not hold."""
    rows, costs, leads = [], [], []
    for site, count in places(slices):
        for value in parameter.changed:
            panel: Panel = ("grid", site, count)
            here = slices[parameter.name, value]
            price = [here.lead(*panel, name + UNAWARE, ours=name) for name in MISLED]
            against = [here.lead(*panel, other, ours="pomdp" + UNAWARE) for other in ("mp", "sys", "stat")]
            against.append(here.lead(*panel, "msp" + UNAWARE, ours="pomdp" + UNAWARE))
            costs.append(price[0])
            leads += against[:3]
            rows.append([site, count, value, *map(signed, price), *map(judged, against)])
    lost = [cost.mean for cost in costs]
    holds = sum(lead.verdict > 0 for lead in leads)
    yield fill(
        f"""**Misfit.** Targets move by the value in the table, and the controller believes in {parameter.own}. Not
        knowing costs P {min(lost):.1f} to {max(lost):.1f} points, beyond doubt in {sum(c.verdict > 0 for c in costs)}
        of {len(costs)} cases. Unaware as it is, P stays above MP, Sys and Stat (who know) beyond doubt in {holds} of
        {len(leads)} comparisons."""
    )
    heads = ["site", "m", parameter.name, "costs P", "costs MSP", *(f"unaware P > {n}" for n in ("MP", "Sys", "Stat"))]
    yield table([*heads, "unaware P > unaware MSP"], rows, 1)


def _out_of_sight(results: Results) -> str:
    """The variants of MP."""
    names = {"mp": "dropped", "mp-hold": "held where last seen", "mp-dead-reckoning": "dead reckoning"}
    panels = results.with_runs_of(OUT_OF_SIGHT[0])
    runs = len(results.samples(*panels[0], OUT_OF_SIGHT[0]))
    results = results.first(runs)
    leads = {(panel, name): results.lead(*panel, name) for panel in panels for name in names}
    kept = [results.lead(*panel, "mp", ours=name).mean for panel in panels for name in OUT_OF_SIGHT]
    sure = sum(lead.verdict > 0 for lead in leads.values())
    said = f"""P minus the variant (the first {runs} runs). Keeping targets in mind changes MP by {min(kept):+.1f} to
    {max(kept):+.1f} points; the interval of P minus the variant lies above zero in {sure} of {len(leads)} cases."""
    rows = [[*panel, *(signed(leads[panel, name]) for name in names)] for panel in panels]
    made = table(["truth", "site", "m", *names.values()], rows, 2)
    return "\n\n".join(["## What MP does with a target out of sight", fill(said), made])


def _lead(slices: Slices, parameter: Parameter, value: str, site: str, count: int, other: str) -> Estimate:
    return slices[parameter.name, value].lead("grid", site, count, other)


def _knows(slices: Slices, parameter: Parameter, value: str, site: str) -> tuple[float, float]:
    """Shares that P and MSP know, in percent."""
    here = slices[parameter.name, value]
    found = [
        here.percent["known", "grid", site, KNOWN_COUNT, name, kappa] for name, kappa in _known_as(value, parameter)
    ]
    ours, theirs = (float(np.mean(list(of.values()))) for of in found)
    return ours, theirs


def _known_as(value: str, parameter: Parameter) -> list[tuple[str, str]]:
    """Under which controller and κ it stands; the comparison has MSP's under each κ, the sites' own being 0.05."""
    return [("pomdp", ""), ("msp", "0.05" if value == parameter.own else "")]
