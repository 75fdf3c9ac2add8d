"""Folders of results: every file whole, and beside them where they come from."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from factored_pomdp.commands.answers import InputError, plain

__all__ = ["PROVENANCE", "finite", "ready_folder", "whole_folder", "write_json"]

PROVENANCE = "provenance.json"


def ready_folder(path: Path) -> Path:
    """The folder, made if need be, once it is known that files can be written there; asked before long work begins.

    Raises
    ------
    InputError
        Saying why not.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as problem:
        raise InputError(_unwritable(path, problem)) from None
    return path


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """A folder to write into; its files appear under ``path`` when all are written, and not at all otherwise.

    ``provenance.json`` comes last. Files of other names that were there stay.

    Raises
    ------
    InputError
        If they cannot be written, as on a full disk.
    """
    workshop = None
    try:
        workshop = Path(tempfile.mkdtemp(prefix=".unfinished-", dir=path))
        yield workshop
        for file in sorted(workshop.iterdir(), key=lambda file: (file.name == PROVENANCE, file.name)):
            os.replace(file, path / file.name)
    except OSError as problem:
        raise InputError(_unwritable(path, problem)) from problem
    finally:
        if workshop is not None:
            shutil.rmtree(workshop, ignore_errors=True)


def _unwritable(path: Path, problem: OSError) -> str:
    return f"cannot write in {path}: {(problem.strerror or str(problem)).lower()}"


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    """One JSON object."""
    path.write_text(json.dumps(plain(content), indent=2, ensure_ascii=False) + "\n", encoding="utf-8")


def finite(number: float) -> float | None:
    """JSON has no nan and no infinity: ``None``."""
    return number if abs(number) < float("inf") else None
