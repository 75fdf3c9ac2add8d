"""What runs of one controller are answered with, simulated or replayed: the measure, the times, an animation."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from surveillance_domain.experiments.recording import Recording
    from surveillance_domain.experiments.runs import Run
    from surveillance_domain.model.build import Surveillance

__all__ = ["measured", "shown_runs", "write_run"]


def measured(done: Mapping[int, Run]) -> dict[str, Any]:
    """PercentObs, times of decisions and restarts of runs, by their numbers; a run without targets has no share.

    Student's interval of few runs is cut where no share can be, below 0 and above 100 %.
    """
    from surveillance_domain.commands.folder import finite
    from surveillance_domain.experiments.estimates import decision_times, percent_obs_of

    found = percent_obs_of(done)
    median, late = decision_times(done.values())
    return {
        "runs": len(done),
        "percent_obs": {
            "mean": finite(found.mean),
            "ci95": found.ends(0.0, 100.0),
            "per_run": [finite(done[number].percent_obs) for number in sorted(done)],
        },
        "decision_ms": {"median": finite(median), "p99": finite(late)},
        "restarts": sum(run.restarts for run in done.values()),
    }


def shown_runs(rows: Table, content: Mapping[str, Any], out: Path | None) -> list[RenderableType]:
    """The table with the rows of `measured` added, and lines about how it ended."""
    found, times = content["percent_obs"], content["decision_ms"]
    low, high = found["ci95"]
    if found["mean"] is not None:
        rows.add_row("PercentObs", f"{found['mean']:.2f} %")
    if low is not None:
        rows.add_row("95 % interval of its mean", f"{low:.2f} … {high:.2f} %")
    if times["median"] is not None:
        rows.add_row("time of a decision, median", f"{times['median']:.3f} ms")
        rows.add_row("99th percentile", f"{times['p99']:.3f} ms")
    rows.add_row("beliefs started anew", str(content["restarts"]))
    shown: list[RenderableType] = [rows]
    if content["interrupted"]:
        shown.append(f"Interrupted; the {content['runs']} runs that were finished are counted.")
    if out is not None:
        shown.append(f"Written to {out}")
    return shown


def write_run(
    out: Path, surveillance: Surveillance | None, recording: Recording | None, heading: str, content: Mapping[str, Any]
) -> None:
    """``run.gif``, ``last-step.png`` and ``.svg``, ``steps.csv`` of a recorded run; the answer, its provenance."""
    from surveillance_domain.commands.folder import PROVENANCE, whole_folder, write_json
    from surveillance_domain.experiments.recording import write_steps
    from surveillance_domain.pictures.animation import draw_frame, write_animation
    from surveillance_domain.pictures.style import save_figure

    with whole_folder(out) as folder:
        if recording is not None and surveillance is not None:
            world = (surveillance.site, surveillance.views)
            write_animation(*world, recording.frames, heading, folder / "run.gif")
            save_figure(draw_frame(*world, recording.frames[-1], heading), folder / "last-step.png")
            write_steps(recording, folder / "steps.csv")
        write_json(folder / "result.json", content)
        write_json(folder / PROVENANCE, content["provenance"])
