"""Statements about boxes of a table, as `Layers` holds them: some coordinates fixed, the others run over all values.

Sets of axes are masks. A box is told by its *free* axes and the *key* of its first place (its row-major position).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

__all__ = ["Block", "Column", "Entries"]


@dataclass(frozen=True)
class Entries:
    """What a table holds.

    Attributes
    ----------
    axes : tuple of int
        Those axes of the table on which anything depends, in order.
    coordinates : (entries, axes) int
    numbers : (entries,) float
        None is zero.
    stamps : (entries,) int
        Which statement each entry comes from.
    """

    axes: tuple[int, ...]
    coordinates: np.ndarray
    numbers: np.ndarray
    stamps: np.ndarray


@dataclass
class Column:
    """Statements of one number each that fix the same axes."""

    keys: list[int] = field(default_factory=list)
    numbers: list[float] = field(default_factory=list)
    stamps: list[int] = field(default_factory=list)
    many: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = field(default_factory=list)

    def arrays(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All keys, numbers and stamps."""
        keys, stamps = np.array(self.keys, dtype=np.int64), np.array(self.stamps, dtype=np.int64)
        chunks = [(keys, np.array(self.numbers, dtype=float), stamps), *self.many]
        keys, numbers, stamps = (np.concatenate(parts) for parts in zip(*chunks, strict=True))
        return keys, numbers, stamps

    def __len__(self) -> int:
        return len(self.keys) + sum(len(keys) for keys, _, _ in self.many)


@dataclass(frozen=True)
class Block:
    """A statement of several numbers: offsets from the box's first place, or ``diagonal`` (how many, how far apart)."""

    free: int
    along: int
    key: int
    stamp: int
    offsets: np.ndarray | None
    numbers: np.ndarray | None
    diagonal: tuple[int, int] = (0, 0)

    @property
    def count(self) -> int:
        return self.diagonal[0] if self.offsets is None else len(self.offsets)

    def laid_out(self) -> tuple[np.ndarray, np.ndarray]:
        if self.offsets is None or self.numbers is None:
            number, step = self.diagonal
            return np.arange(number, dtype=np.int64) * step, np.ones(number)
        return self.offsets, self.numbers
