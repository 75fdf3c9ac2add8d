"""The record of a watch: a folder of files of lines of JSON, appended to step by step.

A line is written whole and at once, so that a kill at any moment loses at most the line that was being written, and
readers pass over a torn last line. Each file begins with a header that says what was run. A new file is begun when one
is full or a new day (UTC) begins; files that are older than the site's ``keep_days`` are removed then. Beliefs are not
stored: they follow from the sightings. No pictures and no passwords are in it.

A line that could not be written, as on a full disk, is an error for the caller; the next line begins a new file, so
that a torn one is always the last of its file.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

__all__ = ["RecordError", "RecordWriter", "read_record"]

_PATTERN = "record-*.jsonl"
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
        What was run; JSON values. ``run`` and ``part`` are added to it: when the run began, and the number of the file.
    keep_days : float
    full_bytes : int

    Raises
    ------
    OSError
        If the folder cannot be written to.
    """

    def __init__(
        self, folder: Path, header: Mapping[str, Any], keep_days: float, full_bytes: int = _FULL_BYTES
    ) -> None:
        self._folder, self._header, self._keep, self._full = folder, dict(header), timedelta(days=keep_days), full_bytes
        folder.mkdir(parents=True, exist_ok=True)
        self._file, self._written, self._day, self._parts = -1, 0, "", 0
        now = datetime.now(UTC)
        self._run = now.isoformat(timespec="microseconds")
        self._begin(now)

    def write(self, entry: Mapping[str, Any]) -> None:
        """Append one line; ``written`` (UTC) is added to it.

        Raises
        ------
        OSError
            If that failed.
        """
        now = datetime.now(UTC)
        if self._file < 0 or self._written >= self._full or now.date().isoformat() != self._day:
            self._begin(now)
        self._line({"kind": "step", "written": now.isoformat(timespec="milliseconds"), **entry})

    def close(self) -> None:
        """No more lines."""
        if self._file >= 0:
            os.close(self._file)
        self._file = -1

    def _begin(self, now: datetime) -> None:
        self.close()
        for old in self._folder.glob(_PATTERN):
            with suppress(OSError):
                if datetime.fromtimestamp(old.stat().st_mtime, UTC) < now - self._keep:
                    old.unlink()
        path = self._folder / f"record-{now:%Y%m%dT%H%M%S.%f}.jsonl"
        self._file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_EXCL, 0o640)
        self._written, self._day = 0, now.date().isoformat()
        header = {**self._header, "run": self._run, "part": self._parts}
        try:
            self._line({"kind": "header", "written": now.isoformat(timespec="milliseconds"), **header})
        except OSError:
            path.unlink(missing_ok=True)
            raise
        self._parts += 1

    def _line(self, content: Mapping[str, Any]) -> None:
        line = (json.dumps(content, ensure_ascii=False, allow_nan=False) + "\n").encode()
        try:
            while line:
                done = os.write(self._file, line)
                self._written, line = self._written + done, line[done:]
        except OSError:
            self.close()
            raise


def read_record(path: Path) -> Iterator[dict[str, Any]]:
    """Headers and steps of a record in their order, from a folder or one of its files.

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
            if not isinstance(content, dict) or content.get("kind") not in ("header", "step"):
                raise RecordError(f"{file}, line {number}: expected a JSON object with a kind, found {line[:60]!r}")
            yield content
