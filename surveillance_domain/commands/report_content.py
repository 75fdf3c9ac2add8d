"""The morning's page: as JSON, as text, as HTML, with one picture."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import COMMAND_LINE, table
from surveillance_domain.commands.folder import ready_folder, whole_folder
from surveillance_domain.commands.report_watch import clock, gap_rows, headline, lasting, run_rows, watch_content

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.console import RenderableType

    from surveillance_domain.control.morning import Morning, Spell

__all__ = ["content_of", "shown", "write_report"]

_MOST_ROWS = 200
_NARROW = 3
"""Columns that a phone has room for."""

_FRAME = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body {{ font: 16px/1.5 system-ui, sans-serif; color: #1a1a1a; max-width: 60rem; margin: 2rem auto; padding: 0 1rem }}
figure {{ margin: 1rem 0 }}
.alarm {{ border-left: .4rem solid #d55e00; padding-left: .8rem; font-weight: 600 }}
svg {{ max-width: 100%; height: auto }}
table {{ border-collapse: collapse; font-variant-numeric: tabular-nums }}
th, td {{ padding: .2rem .8rem .2rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd }}
@media (max-width: 40rem) {{
  .wide tr:first-child {{ display: none }}
  .wide tr {{ display: block; padding: .5rem 0; border-bottom: 1px solid #ddd }}
  .wide td {{ display: grid; grid-template-columns: 4.5rem 1fr; border: 0; padding: 0; overflow-wrap: anywhere }}
  .wide td::before {{ content: attr(data-head); color: #666 }}
}}
</style></head><body>
<h1>{title}</h1>
{body}
<p><small>Made by <code>{command}</code></small></p>
</body></html>
"""


def content_of(record: Path, morning: Morning, why: Mapping[str, Any] | None, trouble: str) -> dict[str, Any]:
    """What JSON has."""
    series, last = morning.series, morning.continuity.runs[-1].header
    return {
        "record": str(record),
        "site": last["site"],
        "controller": last["controller"],
        **watch_content(morning.continuity),
        "steps": morning.steps,
        "hours": morning.continuity.hours,
        "percent_obs": _percent(series.seen, series.present) if "emulated" in _kinds(morning) else None,
        "seen": _mean(series.seen),
        "seen_beyond": morning.beyond / morning.steps,
        "expected_observed": _mean(series.expected),
        "coverage": _mean(series.coverage),
        "unused_detections": morning.unused,
        "outages": [_spell(one) for one in morning.outages],
        "short": dict(morning.short),
        "held": [_spell(one) for one in morning.holds],
        "restarts": morning.restarts,
        "why": None if why is None else dict(why),
        "trouble": trouble,
    }


def _kinds(morning: Morning) -> set[str]:
    return {"emulated" if run.header["emulated"] else "real" for run in morning.continuity.runs}


def _percent(seen: Sequence[float], present: Sequence[float]) -> float | None:
    mean = _mean([one / there for one, there in zip(seen, present, strict=True) if there > 0])
    return None if mean is None else 100 * mean


def _mean(values: Sequence[float]) -> float | None:
    known = [value for value in values if value == value]
    return sum(known) / len(known) if known else None


def _spell(spell: Spell) -> dict[str, Any]:
    return {
        "camera": spell.camera,
        "began": spell.began.isoformat(timespec="seconds"),
        "first_step": spell.first,
        "steps": spell.steps,
        "seconds": spell.seconds,
        "over": spell.over,
        "because": spell.because,
        "mend": spell.mend,
    }


Table = tuple[str, Sequence[str], Sequence[Sequence[str]]]


def _tables(content: Mapping[str, Any]) -> list[Table]:
    """Titles, heads and rows, for text and HTML alike."""
    unwatched, unrecorded = gap_rows(content)
    cameras = [(one["began"], (*_spell_row(one), one["mend"])) for one in content["outages"]]
    outages = [*unwatched, *(row for _, row in sorted([*cameras, *unrecorded], key=lambda one: one[0]))]
    tables: list[Table] = [
        ("", ("the night", "found"), _facts(content)),
        ("Outages", ("camera", "from", "for", "cause", "mend"), outages),
        ("Cameras that people had", ("camera", "from", "for", "why"), [_spell_row(one) for one in content["held"]]),
    ]
    restarts = [(str(one["step"]), clock(one["written"]), ", ".join(one["restarted"])) for one in content["restarts"]]
    tables.append(("Beliefs that were started anew", ("step", "at", "targets"), restarts))
    if content["why"] is not None:
        tables += _why_tables(content["why"])
    return tables


def _facts(content: Mapping[str, Any]) -> list[tuple[str, str]]:
    rows = [("site, controller", f"{content['site']}, {content['controller']}")]
    rows += run_rows(content)
    rows.append(("steps recorded", f"{content['steps']:,}"))
    for key, name, form in (
        ("percent_obs", "PercentObs", "{:.1f} %"),
        ("seen", "targets seen a step", "{:.2f}"),
        ("seen_beyond", "of them beyond the views of the model", "{:.2f}"),
        ("expected_observed", "expected", "{:.2f}"),
    ):
        if content[key] is not None:
            rows.append((name, form.format(content[key])))
    if content["coverage"] is not None:
        rows.append(("floor in view, mean", f"{100 * content['coverage']:.1f} %"))
    rows.append(("detections not used", f"{content['unused_detections']:,}"))
    missing = ", ".join(f"{camera} {count}" for camera, count in content["short"].items())
    rows.append(("views missing for a step or two", missing or "none"))
    if content["trouble"]:
        rows.append(("not known: floor in view", content["trouble"]))
    return rows


def _why_tables(why: Mapping[str, Any]) -> list[Table]:
    def presets(chosen: Mapping[str, str]) -> str:
        return ", ".join(f"{camera} {preset}" for camera, preset in chosen.items())

    def value(number: float | None) -> str:
        return "—" if number is None else f"{number:.4f}"

    turned = ", ".join(f"{name} pan {p[0]:.0f}°, tilt {p[1]:.0f}°" for name, p in why["elsewhere"].items())
    chosen = {camera: preset for camera, preset in why["sent"].items() if camera not in why["elsewhere"]}
    facts = [
        ("chosen", presets(chosen)),
        ("expected number of targets seen", f"{value(why['value'])} ({why['method']})"),
        ("recomputed from the record", value(why["recomputed_value"])),
        ("cameras left out, being away", ", ".join(why["left_out"]) or "none"),
        *([("cameras counted where people have turned them", turned)] if turned else []),
        (
            "what was seen",
            ", ".join(_place(t, c, why["beyond"]) for t, c in why["observations"].items() if c) or "nobody",
        ),
    ]
    if not why["exact"]:
        facts.append(("but", "the record does not begin with its run: the belief is near, not exact"))
    others = [(presets(one["presets"]), value(one["value"])) for one in why["alternatives"]]
    title = f"Step {why['step']}, {clock(why['written'])}"
    return [(title, ("the choice", "found"), facts), ("The best alternatives", ("presets", "value"), others)]


def _place(target: str, cell: Sequence[int], beyond: Mapping[str, str]) -> str:
    return f"{target} at {cell[0]},{cell[1]}" + (f" (beyond the view of {beyond[target]})" if target in beyond else "")


def _spell_row(spell: Mapping[str, Any]) -> tuple[str, ...]:
    length = lasting(spell["seconds"]) + ("" if spell["over"] else ", to the end")
    return spell["camera"], clock(spell["began"]), length, spell["because"]


def shown(content: Mapping[str, Any]) -> list[RenderableType]:
    """The page as text."""
    parts: list[RenderableType] = [*headline(content)]
    for title, heads, rows in _tables(content):
        if not rows:
            parts.append(f"{title}: none")
            continue
        made = table(*heads, title=title or None)
        for row in rows[:_MOST_ROWS]:
            made.add_row(*row)
        parts.append(made)
        if len(rows) > _MOST_ROWS:
            parts.append(f"… and {len(rows) - _MOST_ROWS} more")
    parts += [f"Written to {path}" for path in content.get("written", ())]
    return parts


def write_report(out: Path, content: Mapping[str, Any], morning: Morning) -> list[str]:
    """``report.html``, ``report.txt``, ``night.png`` and ``.svg``, whole or not at all; their paths."""
    from rich.console import Console

    from surveillance_domain.pictures.style import save_figure

    text = io.StringIO()
    console = Console(file=text, width=160, highlight=False, markup=False, emoji=False)
    for part in shown(content):
        console.print(part)
    ready_folder(out)
    with whole_folder(out) as folder:
        save_figure(_picture(morning), folder / "night.png")
        (folder / "report.txt").write_text(text.getvalue(), encoding="utf-8")
        chart = (folder / "night.svg").read_text(encoding="utf-8")
        (folder / "report.html").write_text(_html(content, chart[chart.index("<svg") :]), encoding="utf-8")
        names = sorted(file.name for file in folder.iterdir())
    return [str(out / name) for name in names]


def _html(content: Mapping[str, Any], chart: str) -> str:
    """The page in one file, so that it can be mailed; on a phone the rows of wide tables become lists."""
    alarm = ' class="alarm"' if content["unwatched"] else ""
    parts = [f"<p{alarm}>{'<br>'.join(map(escape, headline(content)))}</p>"]
    for title, heads, rows in _tables(content):
        if title:
            parts.append(f"<h2>{escape(title)}</h2>")
        if not rows:
            parts.append("<p>None.</p>")
            continue
        head = "".join(f"<th>{escape(one)}</th>" for one in heads)
        lines = "".join(f"<tr>{''.join(map(_cell, heads, row))}</tr>" for row in rows)
        wide = ' class="wide"' if len(heads) > _NARROW else ""
        parts.append(f"<table{wide}><tr>{head}</tr>{lines}</table>")
        if not title:
            alt = "Share of targets seen and of the floor in view over time, and which camera was missing when"
            parts.append(f'<figure role="img" aria-label="{alt}">{chart}</figure>')
    title = f"{content['site']}: the night's report"
    return _FRAME.format(title=escape(title), body="\n".join(parts), command=escape(COMMAND_LINE.get()))


def _cell(head: str, content: str) -> str:
    return f'<td data-head="{escape(head)}">{escape(content)}</td>'


def _picture(morning: Morning) -> Figure:
    import numpy as np

    from surveillance_domain.pictures.night import draw_night

    series = morning.series
    hours, seen, present, coverage = (
        np.array(one) for one in (series.hours, series.seen, series.present, series.coverage)
    )
    known = np.isfinite(present) & (present > 0)
    share = np.full(len(seen), np.nan)
    share[known] = seen[known] / present[known]
    gaps: dict[str, list[tuple[float, float]]] = {name: [] for name in morning.cameras}
    for spell in morning.outages:
        gaps[spell.camera].append((spell.began_h, spell.began_h + spell.seconds / 3600))
    kinds = _kinds(morning)
    label = "targets seen, of those there" if kinds == {"emulated"} else "targets seen, of those known of"
    unwatched = [(one.began_h, one.began_h + one.seconds / 3600) for one in morning.continuity.unwatched]
    return draw_night(hours, share, coverage, gaps, label, unwatched)
