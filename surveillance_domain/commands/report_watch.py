"""The first thing that the morning's page says: how long somebody watched, how long nobody did, and why."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from surveillance_domain.control.continuity import Continuity, Gap, RunSpan

__all__ = ["clock", "gap_rows", "headline", "lasting", "run_rows", "watch_content"]

_MINUTE_S, _HOUR_S = 60, 3600
_SECONDS_UP_TO_S = 120.0
_MOST_GAPS = 5


def watch_content(watch: Continuity) -> dict[str, Any]:
    """What JSON has of it."""
    return {
        "runs": [_run(one) for one in watch.runs],
        "watched_s": watch.watched_s,
        "unwatched_s": watch.unwatched_s,
        "unwatched": [_gap(one) for one in watch.unwatched],
        "unrecorded": [{**_gap(one), "first_step": one.first, "steps": one.steps} for one in watch.unrecorded],
    }


def headline(content: Mapping[str, Any]) -> list[str]:
    """How long somebody watched, and when nobody did."""
    told = f"Watched for {lasting(content['watched_s'])}"
    if not content["unwatched"]:
        lines = [f"{told}, without a gap."]
    else:
        away = f", not watched for {lasting(content['unwatched_s'])}" if content["unwatched_s"] else ""
        gaps = content["unwatched"][:_MOST_GAPS]
        lines = [f"{told}{away}.", *(f"{_nobody(gap).capitalize()}: {gap['because']}." for gap in gaps)]
        if len(content["unwatched"]) > _MOST_GAPS:
            lines.append(f"There are {len(content['unwatched']) - _MOST_GAPS:,} more such times: see Outages.")
    missing = sum(gap["steps"] for gap in content["unrecorded"])
    return [*lines, f"Watched, but not recorded: {missing:,} steps."] if missing else lines


def run_rows(content: Mapping[str, Any]) -> list[tuple[str, str]]:
    """When each run began, when it ended, and how."""
    rows = []
    for number, run in enumerate(content["runs"], 1):
        ended = "" if run["ended"] is None else f" to {clock(run['ended'])}"
        last = f", last step at {clock(run['last_step'])}" if run["last_step"] and not ended else ""
        told = f"{clock(run['began'])}{ended}, {run['steps']:,} steps: {run['because']}{last}"
        rows.append((f"run {number}", told))
    return rows


def gap_rows(content: Mapping[str, Any]) -> tuple[list[tuple[str, ...]], list[tuple[str, tuple[str, ...]]]]:
    """Rows of the table of outages: times in which nobody watched; steps not recorded, with when that began."""
    unwatched: list[tuple[str, ...]] = []
    for gap in content["unwatched"]:
        length = lasting(gap["seconds"]) if gap["over"] else "to the end"
        told = f"{_nobody(gap)}; {gap['because']}"
        unwatched.append(("all", clock(gap["began"]), length, told, gap["mend"]))
    unrecorded: list[tuple[str, tuple[str, ...]]] = []
    for gap in content["unrecorded"]:
        told = f"{gap['because']}, {clock(gap['began'])} to {clock(gap['ended'])}"
        row = ("the record", clock(gap["began"]), lasting(gap["seconds"]), told, gap["mend"])
        unrecorded.append((gap["began"], row))
    return unwatched, unrecorded


def clock(moment: str) -> str:
    """In local time."""
    return datetime.fromisoformat(moment).astimezone().strftime("%Y-%m-%d %H:%M:%S")


def lasting(seconds: float) -> str:
    """Such as ``5 h 0 min``."""
    if seconds < _SECONDS_UP_TO_S:
        return f"{seconds:.0f} s"
    minutes = round(seconds / _MINUTE_S)
    hours, left = divmod(minutes, _HOUR_S // _MINUTE_S)
    return f"{hours} h {left} min" if hours else f"{minutes} min"


def _nobody(gap: Mapping[str, Any]) -> str:
    if not gap["over"]:
        return f"nobody watched after {clock(gap['began'])}"
    return f"nobody watched from {clock(gap['began'])} to {clock(gap['ended'])} ({lasting(gap['seconds'])})"


def _run(run: RunSpan) -> dict[str, Any]:
    return {
        **{key: run.header[key] for key in ("run", "command", "version")},
        "began": run.began.isoformat(timespec="seconds"),
        "last_step": None if run.last is None else run.last.isoformat(timespec="seconds"),
        "ended": None if run.ended is None else run.ended.isoformat(timespec="seconds"),
        "how": run.how,
        "because": run.because,
        "steps": run.steps,
    }


def _gap(gap: Gap) -> dict[str, Any]:
    return {
        "began": gap.began.isoformat(timespec="seconds"),
        "ended": gap.ended.isoformat(timespec="seconds") if gap.over else None,
        "seconds": gap.seconds,
        "over": gap.over,
        "because": gap.because,
        "mend": gap.mend,
    }
