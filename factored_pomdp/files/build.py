"""A model from what a file says, with the model's own faults laid at the file's door."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from factored_pomdp.errors import ModelError
from factored_pomdp.files.faults import FileError, FileFault
from factored_pomdp.model import FactoredPOMDP

__all__ = ["built", "with_notes"]


def built(path: Path, **parts: Any) -> FactoredPOMDP:
    """The model, named after the file; `FileError` with all its faults."""
    try:
        return FactoredPOMDP(name=path.stem, **parts)
    except ModelError as problem:
        faults = [FileFault(fault.where, fault.found, fault.expected) for fault in problem.faults]
        raise FileError(path, faults) from problem


def with_notes(model: FactoredPOMDP, notes: Iterable[str]) -> FactoredPOMDP:
    """The same model, just made, with more notes."""
    model.notes = (*model.notes, *notes)
    return model
