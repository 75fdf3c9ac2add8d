"""What a comparison is answered with: JSON, tables, figure, CSV."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import table
from surveillance_domain.commands.folder import PROVENANCE, finite, whole_folder, write_json

if TYPE_CHECKING:
    from rich.console import RenderableType

    from surveillance_domain.experiments.comparison import Plan, Row
    from surveillance_domain.experiments.estimates import Estimate
    from surveillance_domain.experiments.jobs import Outcome
    from surveillance_domain.pictures.comparison import Panel

__all__ = ["comparison_content", "comparison_panels", "comparison_tables", "write_comparison"]

_LEAST, _MOST = 0.0, 100.0
"""Of a share; a difference of two lies between minus the most and the most."""

Names = Mapping[str, str]
"""Sites as given to sites by name."""


def comparison_content(
    plan: Plan, runs: int, outcome: Outcome, names: Names, command: str, inputs: Mapping[str, str]
) -> dict[str, Any]:
    """The answer as JSON has it; ``runs`` is how many were asked for."""
    from factored_pomdp.provenance import provenance
    from surveillance_domain.experiments.comparison import differences, rows

    carried = provenance(command, inputs, plan.seed)
    return {
        "truth": plan.truth,
        "steps": plan.steps,
        "runs": runs,
        "detection_probability": plan.setups[0].detection_probability,
        "cell_noise_m": plan.setups[0].cell_noise_m,
        "rows": [
            {**_record(row, names, _LEAST), "per_run": list(row.estimate.samples), "restarts": row.restarts}
            for row in rows(plan, outcome.runs)
        ],
        "differences": [_record(row, names, -_MOST) for row in differences(plan, outcome.runs)],
        "interrupted": outcome.interrupted,
        **carried,
        "provenance": carried,
    }


def _record(row: Row, names: Names, least: float) -> dict[str, Any]:
    found = row.estimate
    return {
        "site": names[row.setup.site],
        "controller": row.controller,
        "targets": row.setup.targets,
        "mean": finite(found.mean),
        "ci95": found.ends(least, _MOST),
        "runs": len(found.samples),
    }


def comparison_tables(plan: Plan, outcome: Outcome, names: Names) -> list[RenderableType]:
    """Two tables a site: PercentObs, and P minus the others."""
    from surveillance_domain.experiments.comparison import differences, panels, rows
    from surveillance_domain.experiments.variants import ALL_NAMES

    shown: list[RenderableType] = []
    kinds = (("PercentObs", panels(rows(plan, outcome.runs))), ("P minus", panels(differences(plan, outcome.runs))))
    for site in dict.fromkeys(setup.site for setup in plan.setups):
        for what, found in kinds:
            if site not in found:
                continue
            heads = [ALL_NAMES[controller] for controller in found[site]]
            made = table("m", *heads, title=f"{names[site]}: {what}, {plan.truth} truth", right=["m", *heads])
            cells = {(c, row.setup.targets): row.estimate for c, of in found[site].items() for row in of}
            for count in dict.fromkeys(setup.targets for setup in plan.setups):
                line = [_cell(cells.get((controller, count)), what != "PercentObs") for controller in found[site]]
                made.add_row(str(count), *line)
            shown.append(made)
    return shown


def _cell(found: Estimate | None, signed: bool) -> str:
    if found is None:
        return ""
    mean = f"{found.mean:+.1f}" if signed else f"{found.mean:.1f}"
    return mean if finite(found.half_width) is None else f"{mean} ± {found.half_width:.1f}"


def comparison_panels(found: Sequence[Row], names: Names) -> list[Panel]:
    """Rows as the figure takes them."""
    from surveillance_domain.experiments.comparison import panels
    from surveillance_domain.experiments.variants import ALL_NAMES
    from surveillance_domain.pictures.comparison import Curve, Panel

    return [
        Panel(
            names[site],
            tuple(
                Curve(
                    controller,
                    ALL_NAMES[controller],
                    tuple(row.setup.targets for row in of),
                    tuple(row.estimate.mean for row in of),
                    tuple(_end(row, 0) for row in of),
                    tuple(_end(row, 1) for row in of),
                )
                for controller, of in controllers.items()
            ),
        )
        for site, controllers in panels(found).items()
    ]


def _end(row: Row, which: int) -> float:
    found = row.estimate.ends(_LEAST, _MOST)[which]
    return math.nan if found is None else found


def write_comparison(out: Path, plan: Plan, outcome: Outcome, names: Names, content: Mapping[str, Any]) -> None:
    """``comparison.png``, ``.svg`` and ``.csv``, ``differences.csv``, ``result.json``, ``provenance.json``."""
    from surveillance_domain.experiments.comparison import rows
    from surveillance_domain.pictures.comparison import draw_comparison
    from surveillance_domain.pictures.style import save_figure

    found = rows(plan, outcome.runs)
    with whole_folder(out) as folder:
        if found:
            counts = [len(row.estimate.samples) for row in found]
            runs = f"{min(counts)}" if min(counts) == max(counts) else f"{min(counts)} to {max(counts)}"
            note = (
                f"{runs} runs of {plan.steps} steps, seed {plan.seed}; bands: 95 % confidence; grey and dashed: bounds"
            )
            figure = draw_comparison(comparison_panels(found, names), f"Targets observed, {plan.truth} truth", note)
            save_figure(figure, folder / "comparison.png")
        _write_csv(folder / "comparison.csv", plan, content["rows"])
        _write_csv(folder / "differences.csv", plan, content["differences"])
        write_json(folder / "result.json", content)
        write_json(folder / PROVENANCE, content["provenance"])


def _write_csv(path: Path, plan: Plan, records: Sequence[Mapping[str, Any]]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["site", "truth", "controller", "targets", "mean", "low", "high", "runs", "steps", "seed"])
        for one in records:
            numbers = ["" if n is None else f"{n:.4f}" for n in (one["mean"], *one["ci95"])]
            start = [one["site"], plan.truth, one["controller"], one["targets"]]
            writer.writerow([*start, *numbers, one["runs"], plan.steps, plan.seed])
