"""The numbers at the top of the page."""

from __future__ import annotations

from datetime import timedelta
from html import escape

from surveillance_domain.page.snapshot import Snapshot

__all__ = ["headline"]


def headline(snapshot: Snapshot | None, age_s: float = 0.0, overdue_s: float = float("inf")) -> str:
    """HTML of the numbers of a step; a warning if the next one is overdue.

    Parameters
    ----------
    age_s : float
        How long ago the step came.
    overdue_s : float
        When that is too long.
    """
    if snapshot is None:
        return '<p class="waiting">Waiting for the first step.</p>'
    with_view = sum(camera.has_view for camera in snapshot.cameras)
    tiles = [
        ("step", f"{snapshot.number:,}"),
        ("since the start", str(timedelta(seconds=int(snapshot.time_s)))),
        ("PercentObs", "no truth" if snapshot.percent_obs is None else f"{snapshot.percent_obs:.1f} %"),
        ("seen now", f"{snapshot.seen} of {snapshot.present}"),
        ("expected", "–" if snapshot.expected is None else f"{snapshot.expected:.2f}"),
        ("cameras with a view", f"{with_view} of {len(snapshot.cameras)}"),
        ("decision", f"{snapshot.decision_ms:.1f} ms"),
        ("beliefs restarted", str(snapshot.restarts)),
    ]
    cells = "".join(f"<div><dt>{escape(name)}</dt><dd>{escape(value)}</dd></div>" for name, value in tiles)
    late = f'<p class="late">No step for {age_s:.0f} s.</p>' if age_s > overdue_s else ""
    return f"{late}<dl>{cells}</dl>"
