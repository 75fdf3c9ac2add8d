"""The record of ``surveillance run``: begun, watched over, and closed with how the run ended."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import InputError, side_console

if TYPE_CHECKING:
    from surveillance_domain.control.record import RecordWriter
    from surveillance_domain.control.watch import Alert, Watch

__all__ = ["begun_record", "closed_record", "missing_steps", "summed_up", "telling_of"]


def begun_record(folder: Path, header: Mapping[str, Any], keep_days: float) -> RecordWriter:
    """A record in a folder; where the disk is full, or fails, it begins when that is over.

    Raises
    ------
    InputError
        If it cannot be written there, and not because of the disk.
    """
    from surveillance_domain.control.record import RecordWriter

    try:
        return RecordWriter(folder, header, keep_days)
    except OSError as problem:
        raise InputError(f"--record {folder}: {(problem.strerror or str(problem)).lower()}") from None


def telling_of(folder: Path, alert: Alert | None) -> Alert:
    """The alert, with a warning on standard error when recording begins to fail, and when it works again."""
    from surveillance_domain.control.watch import THE_RECORD

    def tell(camera: str, state: str, reason: str) -> None:
        if camera == THE_RECORD:
            now = f"cannot be written: {reason}; the watch goes on without it" if reason else "is written again"
            side_console().print(f"warning: --record {folder}: the record {now}", soft_wrap=True)
        if alert is not None:
            alert(camera, state, reason)

    return tell


@contextmanager
def closed_record(watch: Watch) -> Iterator[None]:
    """What ends the run by force in here is told in its record, unless that was closed before."""
    try:
        yield
    except KeyboardInterrupt:
        watch.end("stopped", "interrupted at once, by a second signal")
        raise
    except BaseException as problem:
        watch.end("error", f"failed: {type(problem).__name__}")
        raise


def summed_up(watch: Watch, written: RecordWriter | None) -> dict[str, Any]:
    """The watch's summary, with the step that was recorded until the end of the run took its place."""
    found = watch.summary()
    if written is None or not written.taken_off:
        return found
    because = found["unrecorded_because"] or "no room for how the run ended"
    return {**found, "unrecorded": found["unrecorded"] + written.taken_off, "unrecorded_because": because}


def missing_steps(content: Mapping[str, Any], folder: Path | None) -> str:
    """How many steps are not in the record, and why; empty if all are."""
    if not content["unrecorded"]:
        return ""
    missing = f"{content['unrecorded']:,} of {content['steps']:,} steps are not in the record {folder}"
    return f"{missing}: {content['unrecorded_because']}"
