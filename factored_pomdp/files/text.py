"""Files as bytes and text: bounded when read, whole or not at all when written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable
from pathlib import Path

from factored_pomdp.files.faults import FileError, FileFault

__all__ = ["MOST_BYTES", "as_text", "read_bytes", "write_text"]

MOST_BYTES = 256_000_000
"""Larger files are not read."""


def read_bytes(path: Path) -> bytes:
    """The content of a regular file.

    Raises
    ------
    OSError
        Where there is no such file, or it may not be read.
    FileError
        Where it is no regular file, or larger than `MOST_BYTES`.
    """
    size = path.stat().st_size
    if not path.is_file():
        raise FileError(path, [FileFault("file", "something that is not a regular file", "a file")])
    if size > MOST_BYTES:
        raise FileError(path, [FileFault("file", f"{size:,} bytes", f"at most {MOST_BYTES:,}")])
    return path.read_bytes()


def as_text(path: Path, content: bytes) -> str:
    """Text in UTF-8, or in Latin-1 as older files have it; `FileError` for binary content."""
    if b"\0" in content:
        line = content[: content.index(b"\0")].count(b"\n") + 1
        raise FileError(path, [FileFault("file", "a zero byte", "a text file", line)])
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("latin-1")


def write_text(path: Path, parts: Iterable[str]) -> None:
    """Write a file beside its place and move it there when it is complete."""
    folder = path.parent
    handle, beside = tempfile.mkstemp(prefix=f".{path.name}.", dir=folder)
    try:
        with os.fdopen(handle, "w", encoding="utf-8", newline="\n") as file:
            file.writelines(parts)
        os.chmod(beside, 0o666 & ~_umask())
        os.replace(beside, path)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


def _umask() -> int:
    current = os.umask(0o022)
    os.umask(current)
    return current
