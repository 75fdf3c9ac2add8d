"""The page that shows what the demonstration made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import COMMAND_LINE
from surveillance_domain.commands.folder import PROVENANCE, whole_folder, write_json

if TYPE_CHECKING:
    from factored_pomdp.verification import Verification

__all__ = ["write_page"]

_FRAME = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>Demonstration</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }}
img {{ max-width: 100%; height: auto }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums }}
th, td {{ padding: .2rem .8rem; text-align: right; border-bottom: 1px solid #ddd }}
figure {{ margin: 1rem 0 2rem }} figcaption {{ color: #555; font-size: .9rem }}
</style></head><body>
{body}
</body></html>
"""


def write_page(out: Path, verified: Verification, hall: Mapping[str, Any], office: Mapping[str, Any]) -> Path:
    """Write ``index.html`` and ``provenance.json``; returns the page's path.

    Parameters
    ----------
    hall, office : mapping
        Answers of the comparison and of the simulation, as JSON has them.
    """
    from factored_pomdp.provenance import provenance
    from surveillance_domain.experiments.variants import ALL_NAMES

    rows: Sequence[Mapping[str, Any]] = hall["rows"]
    seed, inputs = hall["seed"], {**hall["inputs"], **office["inputs"]}
    controllers = list(dict.fromkeys(row["controller"] for row in rows))
    cells = {(row["targets"], row["controller"]): row for row in rows}
    heads = "".join(f"<th>{escape(ALL_NAMES[name])}</th>" for name in controllers)
    lines = "".join(
        f"<tr><th>{count}</th>{''.join(f'<td>{_cell(cells[count, name])}</td>' for name in controllers)}</tr>"
        for count in dict.fromkeys(row["targets"] for row in rows)
    )
    found = "no difference above rounding" if verified.holds else "a difference: see verify/result.json"
    mean = office["percent_obs"]["mean"]
    body = f"""<h1>What the demonstration made</h1>
<p>Made by <code>{escape(COMMAND_LINE.get())}</code>, seed {seed}.
Every folder holds a <code>provenance.json</code>.</p>
<h2>1. The decomposition, checked</h2>
<p>The exponential solver and the linear decomposition were compared on {verified.beliefs} random beliefs of two targets
at the site <i>tiny</i>: {found}. Largest difference of values {verified.max_value_difference:.1e}, of beliefs
{verified.max_belief_difference:.1e}. Brute force took {verified.joint_seconds:.1f} s, the decomposition
{verified.decomposed_seconds:.3f} s. <a href="verify/result.json">Numbers</a></p>
<h2>2. All controllers on the hall</h2>
<figure><img src="hall/comparison.svg" alt="PercentObs against the number of targets for every controller">
<figcaption>P is the paper's controller; bounds know what no camera shows. <a href="hall/comparison.csv">Means</a>,
<a href="hall/differences.csv">paired differences</a>, <a href="hall/result.json">all runs</a></figcaption></figure>
<table><tr><th>m</th>{heads}</tr>{lines}</table>
<h2>3. Controller P on a real map</h2>
<p>{office["targets"]} targets walk through the office ({office["runs"]} runs of {office["steps"]} steps):
{mean:.1f} % of them are observed on average; a decision takes {office["decision_ms"]["median"]:.2f} ms (median).</p>
<figure><img src="office/run.gif" alt="A run: targets, fields of view, belief">
<figcaption>The first run. <a href="office/last-step.svg">Last step</a>, <a href="office/steps.csv">step by step</a>,
<a href="office/result.json">numbers</a></figcaption></figure>
<h2>4. What the cameras cover</h2>
<figure><img src="coverage/office.svg" alt="Fields of view in the office"></figure>
<figure><img src="coverage/hall.svg" alt="Fields of view in the hall"></figure>"""
    with whole_folder(out) as folder:
        (folder / "index.html").write_text(_FRAME.format(body=body), encoding="utf-8")
        write_json(folder / PROVENANCE, provenance(COMMAND_LINE.get(), inputs, seed))
    return out / "index.html"


def _cell(row: Mapping[str, Any]) -> str:
    low, high = row["ci95"]
    mean = f"{row['mean']:.1f}"
    return mean if low is None else f"{mean}&nbsp;±&nbsp;{(high - low) / 2:.1f}"
