"""``surveillance report``: the morning's page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import AsJson, InputError, answer
from surveillance_domain.commands.recorded import lines_of, model_of

if TYPE_CHECKING:
    from surveillance_domain.control.morning import Morning
    from surveillance_domain.model.build import Surveillance
    from surveillance_domain.model.elsewhere import Place

__all__ = ["report"]

_ALTERNATIVES = 5


def report(
    record: Annotated[Path, typer.Argument(metavar="RECORD", help="A record's folder, or one of its files.")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder for report.html, report.txt, night.png.")
    ] = None,
    step: Annotated[
        int | None, typer.Option(min=1, help="Also: why that step of the last run was chosen as it was.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Sum up a night: when nobody watched, outages with cause and mend, held cameras, restarts, what was seen."""
    from surveillance_domain.commands.report_content import content_of, shown, write_report

    surveillance, trouble = _model(record)
    morning = _summed_up(record, surveillance)
    if not morning.steps:
        raise InputError(f"{record}: a record without steps")
    why = None if step is None else _why(record, morning, surveillance, trouble, step)
    content = content_of(record, morning, why, trouble)
    if out is not None:
        content["written"] = write_report(out, content, morning)
    answer(content, shown(content), as_json=as_json)


def _model(record: Path) -> tuple[Surveillance | None, str]:
    """The model of the record's last run, or why it cannot be had."""
    last = None
    for line in lines_of(record):
        if line["kind"] == "header":
            last = line
    if last is None:
        raise InputError(f"{record}: a record without a header; give the folder with all of its files")
    try:
        return model_of(last), ""
    except InputError as problem:
        return None, str(problem)


def _summed_up(record: Path, surveillance: Surveillance | None) -> Morning:
    from functools import lru_cache

    from surveillance_domain.control.morning import Morning
    from surveillance_domain.control.record import is_being_written
    from surveillance_domain.model.elsewhere import Elsewhere

    if surveillance is None:
        morning = Morning()
    else:
        cameras, views = surveillance.site.cameras, surveillance.views
        names = [[preset.name for preset in camera.presets] for camera in cameras]

        elsewhere = Elsewhere(surveillance.site)

        @lru_cache(maxsize=4096)
        def share(looks: tuple[str | None, ...], places: tuple[tuple[str, Place], ...]) -> float:
            numbers = [None if look is None else own.index(look) for look, own in zip(looks, names, strict=True)]
            return float(((views.seen(numbers) > 0) | (elsewhere.missed(dict(places)) < 1)).mean())

        def coverage(step: Mapping[str, Any]) -> float:
            looks = tuple(step["views"][camera.name] for camera in cameras)
            return share(looks, tuple((name, (p[0], p[1], p[2])) for name, p in step.get("elsewhere", {}).items()))

        morning = Morning(coverage)
    for line in lines_of(record):
        morning.take(line)
    morning.end(running=is_being_written(record), whole=record.is_dir())
    return morning


def _why(record: Path, morning: Morning, surveillance: Surveillance | None, trouble: str, step: int) -> dict[str, Any]:
    """The choice of a step, its value and the best alternatives, from the belief that the record leads to."""
    from surveillance_domain.control.replaying import Refilter

    if surveillance is None:
        raise InputError(f"--step {step}: {trouble}")
    refilter, run, taken = Refilter(surveillance), morning.continuity.runs[-1].header["run"], 0
    inside = False
    for line in lines_of(record):
        if line["kind"] == "header":
            inside = line["run"] == run
        elif not inside or line["kind"] != "step":
            continue
        elif line["step"] == step:
            valued = [
                ({name.removesuffix(".move"): preset for name, preset in choice.items()}, value)
                for choice, value in refilter.values()
            ]
            chosen = {name: line["sent"][name] for name in (valued[0][0] if valued else {})}
            apart = line["sent"].keys() - chosen.keys()
            ranked = sorted(valued, key=lambda one: -one[1])
            return {
                "step": step,
                "written": line["written"],
                "sent": line["sent"],
                "value": line["value"],
                "method": line["method"],
                "left_out": sorted(apart - refilter.elsewhere.keys()),
                "elsewhere": {
                    name: list(refilter.elsewhere[name]) for name in sorted(apart & refilter.elsewhere.keys())
                },
                "recomputed_value": next((value for choice, value in valued if choice == chosen), None),
                "exact": taken == step - 1,
                "alternatives": [{"presets": choice, "value": value} for choice, value in ranked if choice != chosen][
                    :_ALTERNATIVES
                ],
                "observations": {**line["observations"], **line["unknown"]},
                "beyond": line.get("beyond", {}),
                "views": line["views"],
            }
        else:
            refilter.take(line)
            taken += 1
    raise InputError(f"--step {step}: the last run of this record has no such step ({taken} are there)")
