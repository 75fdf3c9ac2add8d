"""The record of a watch: a folder of files of lines of JSON, appended to step by step.

A line is written whole and at once, so that a kill at any moment loses at most the line that was being written, and
readers pass over a torn last line. Each file begins with a header that says what was run. A new file is begun when one
is full or a new day (UTC) begins; files that are older than the site's ``keep_days`` are removed then. Beliefs are not
stored: they follow from the sightings. No pictures and no passwords are in it. The last line of a run says how it
ended; where that is missing, the run was killed, or is still there: the file that it writes is locked.

A line that could not be written, as on a full disk, is taken off again; a new file is begun for it, and if that fails
too, it is an error for the caller. How the run ended needs so little room that it is written all the same, if need be
where the last step stood, which then counts as one that is not recorded.
"""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from surveillance_domain.control.disk import disk_fails

__all__ = ["RecordError", "RecordWriter", "is_being_written", "read_record"]

_PATTERN = "record-*.jsonl"
_KINDS = ("header", "step", "end")
_FULL_BYTES = 50_000_000


class RecordError(ValueError):
    """A record that cannot be read; the message names file and line."""


class RecordWriter:
    """Appends to a folder.

    Parameters
    ----------
    folder : Path
        Made if it is not there.
    header : mapping
        What was run; JSON values. Added to it: ``run``, when the run began; ``part``, the number of the file; and
        ``closes``, that the run's last line says how it ended (in older records it does not).
    keep_days : float
    full_bytes : int

    Attributes
    ----------
    taken_off : int
        Steps that were recorded, and had to make room for how the run ended.

    Raises
    ------
    OSError
        If the folder cannot be written to, though the disk has room and may be written to. A disk that fails may mend:
        then the record begins with the first line that can be written.
    """

    def __init__(
        self, folder: Path, header: Mapping[str, Any], keep_days: float, full_bytes: int = _FULL_BYTES
    ) -> None:
        self._folder, self._header, self._keep, self._full = folder, dict(header), timedelta(days=keep_days), full_bytes
        self._file, self._written, self._day, self._parts = -1, 0, "", 0
        self._lock, self.taken_off = -1, 0
        self._last: Path | None = None
        now = datetime.now(UTC)
        self._run = now.isoformat(timespec="microseconds")
        try:
            self._goes_on_in(self._begin(now))
        except OSError as problem:
            if not disk_fails(problem):
                raise

    def write(self, entry: Mapping[str, Any]) -> None:
        """Append one line; ``written`` (UTC) is added to it.

        Raises
        ------
        OSError
            If that failed.
        """
        self._append("step", entry)

    def end(self, entry: Mapping[str, Any]) -> None:
        """Append the run's last line, and close; a step that has to make room for it is added to its ``unrecorded``.

        Raises
        ------
        OSError
            If that failed; it is closed all the same.
        """
        try:
            self._append("end", entry)
        except OSError:
            if self._last is None:
                raise
            self.taken_off = self._make_room(self._last)
            self._append("end", {**entry, "unrecorded": entry.get("unrecorded", 0) + self.taken_off})
        finally:
            self.close()

    def close(self) -> None:
        """No more lines."""
        self._close_file()
        if self._lock >= 0:
            os.close(self._lock)
        self._lock = -1

    def _append(self, kind: str, entry: Mapping[str, Any]) -> None:
        now = datetime.now(UTC)
        content = {"kind": kind, "written": now.isoformat(timespec="milliseconds"), **entry}
        if self._file >= 0 and self._written < self._full and now.date().isoformat() == self._day:
            with suppress(OSError):  # this file may grow no further, but another may be begun
                return self._line(content)
        begun = self._begin(now)
        try:
            self._line(content)
        except OSError:
            begun.unlink(missing_ok=True)
            self._parts -= 1
            raise
        self._goes_on_in(begun)
        return None

    def _close_file(self) -> None:
        if self._file >= 0:
            os.close(self._file)
        self._file = -1

    def _begin(self, now: datetime) -> Path:
        """A new file with a header."""
        self._close_file()
        self._folder.mkdir(parents=True, exist_ok=True)
        for old in self._folder.glob(_PATTERN):
            with suppress(OSError):
                if datetime.fromtimestamp(old.stat().st_mtime, UTC) < now - self._keep:
                    old.unlink()
        path = self._folder / f"record-{now:%Y%m%dT%H%M%S.%f}.jsonl"
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_EXCL, 0o640)
        self._written, self._day = 0, now.date().isoformat()
        header = {**self._header, "run": self._run, "part": self._parts, "closes": True}
        try:
            self._line({"kind": "header", "written": now.isoformat(timespec="milliseconds"), **header})
        except OSError:
            path.unlink(missing_ok=True)
            raise
        self._parts += 1
        return path

    def _make_room(self, last: Path) -> int:
        """Go on in the last file, without its last line if that is a step; how many steps that costs."""
        self._close_file()
        self._file = os.open(last, os.O_RDWR | os.O_APPEND)
        whole = last.read_bytes()
        begins = whole[:-1].rfind(b"\n") + 1
        step = whole[begins:].startswith(b'{"kind": "step"')
        self._written, self._day = (begins if step else len(whole)), datetime.now(UTC).date().isoformat()
        os.ftruncate(self._file, self._written)
        return int(step)

    def _goes_on_in(self, last: Path) -> None:
        """Hold the lock of the last file that has lines, also while nothing can be written to it."""
        self._last = last
        before, self._lock = self._lock, os.open(last, os.O_RDONLY)
        with suppress(OSError):  # a file system without locks
            fcntl.flock(self._lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
        if before >= 0:
            os.close(before)

    def _line(self, content: Mapping[str, Any]) -> None:
        line, whole = (json.dumps(content, ensure_ascii=False, allow_nan=False) + "\n").encode(), self._written
        try:
            while line:
                done = os.write(self._file, line)
                self._written, line = self._written + done, line[done:]
        except OSError:
            with suppress(OSError):
                os.ftruncate(self._file, whole)
            self._close_file()
            raise


def is_being_written(path: Path) -> bool:
    """Whether a run is there that writes this record (a folder or a file), as far as the file system tells."""
    files = sorted(path.glob(_PATTERN)) if path.is_dir() else [path]
    if not files:
        return False
    try:
        with files[-1].open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False


def read_record(path: Path) -> Iterator[dict[str, Any]]:
    """Headers, steps and last lines of runs in their order, from a folder or one of its files.

    Raises
    ------
    RecordError
        Where there is none, or a line that is not the last of its file is no JSON object.
    """
    files = sorted(path.glob(_PATTERN)) if path.is_dir() else [path]
    if not files or not files[0].is_file():
        raise RecordError(f"{path}: no record here; expected a folder that `surveillance run --record` wrote")
    for file in files:
        yield from _lines(file)


def _lines(file: Path) -> Iterator[dict[str, Any]]:
    torn = ""
    with file.open(encoding="utf-8", errors="replace") as lines:
        for number, line in enumerate(lines, 1):
            if torn:
                raise RecordError(f"{file}, line {number - 1}: expected a JSON object with a kind, found {torn[:60]!r}")
            try:
                content = json.loads(line)
            except json.JSONDecodeError:
                torn = line
                continue
            if not isinstance(content, dict) or content.get("kind") not in _KINDS:
                raise RecordError(f"{file}, line {number}: expected a JSON object with a kind, found {line[:60]!r}")
            yield content
