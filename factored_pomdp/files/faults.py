"""What is wrong with a file: every fault with its line, all of them at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from factored_pomdp.errors import Fault, ModelError

__all__ = ["MOST_FAULTS", "FaultList", "FileError", "FileFault", "shortened"]

MOST_FAULTS = 1_000
"""After so many faults no more are looked for."""

_SHOWN = 40
_LONGEST = 60


@dataclass(frozen=True)
class FileFault(Fault):
    """One thing that is wrong with a file; ``line`` counts from 1, and is ``None`` where something is missing."""

    line: int | None = None

    def __str__(self) -> str:
        place = f"line {self.line}: " if self.line is not None else ""
        return place + super().__str__()


class FileError(ModelError):
    """A file that holds no well-formed model; ``faults`` holds everything that is wrong with it, by line."""

    def __init__(self, path: Path, faults: Iterable[FileFault]) -> None:
        self.path = path
        self.faults: tuple[FileFault, ...] = tuple(faults)
        count = len(self.faults)
        if count == 1:
            ValueError.__init__(self, f"{path}: {self.faults[0]}")
            return
        lines = [f"{path}: {count} faults", *(f"  {fault}" for fault in self.faults[:_SHOWN])]
        if count > _SHOWN:
            lines.append(f"  … and {count - _SHOWN} more (all of them are in .faults)")
        ValueError.__init__(self, "\n".join(lines))


class FaultList:
    """Gathers faults while a file is read.

    A fault is noted with a stamp: a number by which the reader can tell the line later on (counting lines while all is
    well would be wasted).
    """

    def __init__(self) -> None:
        self._noted: list[tuple[int | None, str, str, str]] = []

    def note(self, stamp: int | None, where: str, found: str, expected: str) -> None:
        """Add a fault; ``stamp`` is ``None`` where no place in the file can be named."""
        self._noted.append((stamp, where, found, expected))

    def __len__(self) -> int:
        return len(self._noted)

    @property
    def full(self) -> bool:
        """Whether it is of no use to go on."""
        return len(self._noted) >= MOST_FAULTS

    def raise_if_any(self, path: Path, lines_of: Callable[[set[int]], dict[int, int]]) -> None:
        """Raise `FileError` with everything noted; ``lines_of`` turns stamps into line numbers."""
        if not self._noted:
            return
        lines = lines_of({stamp for stamp, *_ in self._noted if stamp is not None})
        faults = [
            FileFault(where, found, expected, None if stamp is None else lines[stamp])
            for stamp, where, found, expected in self._noted
        ]
        raise FileError(path, sorted(faults, key=lambda fault: (fault.line is None, fault.line or 0)))


def shortened(text: str) -> str:
    """The text in quotes, cut where it is long."""
    return repr(text if len(text) <= _LONGEST else text[:_LONGEST] + "…")
