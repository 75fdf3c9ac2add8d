"""A table written in layers, as both file formats do it: what is said later holds, and ``*`` stands for every value.

Each statement fills a box: some coordinates are fixed, the others run over all values. Boxes are not laid out as they
come (``T: * : * : * 0.0`` over 10,000 states would be a billion numbers), but once, when all has been said: only the
entries that are not zero are made, and those that a later box covers are dropped. Time n log n in the entries that are
made, for each of the few patterns of fixed coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.files.doubts import Doubts

__all__ = ["MOST_ENTRIES", "Entries", "Layers"]

MOST_ENTRIES = 20_000_000
"""Entries that one table of a file may have."""

_WIDEST = 2**62


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
class _Column:
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


@dataclass(frozen=True)
class _Block:
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


class Layers:
    """A table in the making.

    Parameters
    ----------
    shape : sequence of int
        Sizes of the axes.

    Attributes
    ----------
    doubts : Doubts
        Where statements could not be read.

    Notes
    -----
    Coordinates are sequences with a value's position for each axis, or -1 where all of them are meant. ``stamp`` must
    grow from statement to statement.
    """

    def __init__(self, shape: Sequence[int]) -> None:
        self.shape = tuple(shape)
        if math.prod(self.shape) > _WIDEST:
            raise TooLarge(f"a table of {' × '.join(map(str, self.shape))} places")
        self.strides = tuple(math.prod(self.shape[axis + 1 :]) for axis in range(len(self.shape)))
        self._columns: dict[int, _Column] = {0: _Column()}
        self._blocks: list[_Block] = []
        self._used = 0
        self.doubts = Doubts(self.shape)

    def scalar(self, coordinates: Sequence[int], number: float, stamp: int) -> None:
        """One number for a whole box."""
        key, free = self._place(coordinates)
        column = self._columns.setdefault(free, _Column())
        column.keys.append(key)
        column.numbers.append(number)
        column.stamps.append(stamp)

    def scalars(self, coordinates: np.ndarray, numbers: np.ndarray, stamps: np.ndarray) -> None:
        """Many statements of one number each: a row of coordinates, a number and a stamp for each of them."""
        axes = np.arange(len(self.shape))
        patterns = (coordinates < 0) @ (1 << axes)
        keys = np.maximum(coordinates, 0) @ np.array(self.strides, dtype=np.int64)
        for free in np.unique(patterns).tolist():
            same = patterns == free
            self._columns.setdefault(free, _Column()).many.append((keys[same], numbers[same], stamps[same]))
            self._used |= (1 << len(self.shape)) - 1 & ~free

    def array(self, coordinates: Sequence[int], along: Sequence[int], numbers: np.ndarray, stamp: int) -> None:
        """Numbers along some free axes (row-major), the same for all values of the other free ones."""
        key, free = self._place(coordinates)
        flat = np.flatnonzero(numbers)
        offsets = np.zeros(len(flat), dtype=np.int64)
        within = flat
        for axis in reversed(along):
            offsets += within % self.shape[axis] * self.strides[axis]
            within = within // self.shape[axis]
        self._add(_Block(free, sum(1 << axis for axis in along), key, stamp, offsets, np.asarray(numbers)[flat]))

    def diagonal(self, coordinates: Sequence[int], along: tuple[int, int], stamp: int) -> None:
        """One where two free axes of the same size agree, and zero elsewhere."""
        key, free = self._place(coordinates)
        first, second = along
        step = self.strides[first] + self.strides[second]
        self._add(_Block(free, 1 << first | 1 << second, key, stamp, None, None, (self.shape[first], step)))

    def entries(self, keep: Sequence[int] = ()) -> Entries:
        """What the table holds when all has been said.

        Parameters
        ----------
        keep : sequence of int
            Axes that are part of the result even if nothing depends on them.

        Raises
        ------
        TooLarge
            Beyond `MOST_ENTRIES`, before they are made.
        """
        axes = self._axes(keep)
        covers = self._covers()
        keys, numbers, stamps = self._expanded(axes, covers)
        order = np.lexsort((stamps, keys))
        keys, numbers, stamps = keys[order], numbers[order], stamps[order]
        last = np.append(keys[1:] != keys[:-1], True) if len(keys) else np.zeros(0, dtype=bool)
        keys, numbers, stamps = keys[last], numbers[last], stamps[last]
        holds = ~self._covered(keys, stamps, 0, covers) & (numbers != 0)
        keys = keys[holds]
        columns = [keys // self.strides[axis] % self.shape[axis] for axis in axes]
        coordinates = np.stack(columns, axis=1) if axes else np.zeros((len(keys), 0), dtype=np.int64)
        return Entries(axes, coordinates, numbers[holds], stamps[holds])

    def has_wide_numbers(self) -> bool:
        """Whether numbers other than zero, each for many places, alone may make up too many entries."""
        axes = self._axes(())
        made = (
            int(np.count_nonzero(column.arrays()[1])) * self._extent(free, axes)
            for free, column in self._columns.items()
            if free
        )
        return sum(made) > MOST_ENTRIES

    def _add(self, block: _Block) -> None:
        self._used |= block.along
        self._blocks.append(block)

    def _place(self, coordinates: Sequence[int]) -> tuple[int, int]:
        key = free = 0
        for axis, position in enumerate(coordinates):
            if position < 0:
                free |= 1 << axis
            else:
                key += position * self.strides[axis]
        self._used |= (1 << len(self.shape)) - 1 & ~free
        return key, free

    def _axes(self, keep: Sequence[int]) -> tuple[int, ...]:
        return tuple(axis for axis in range(len(self.shape)) if self._used >> axis & 1 or axis in keep)

    def _covers(self) -> dict[int, tuple[np.ndarray, np.ndarray]]:
        """For each set of free axes: the boxes there are, sorted, and when each was last filled."""
        said = {free: [column.arrays()[::2]] for free, column in self._columns.items() if free}
        for free, blocks in self._by_pattern().items():
            keys = np.array([block.key for block in blocks], dtype=np.int64)
            said.setdefault(free, []).append((keys, np.array([block.stamp for block in blocks], dtype=np.int64)))
        covers = {}
        for free, parts in said.items():
            keys, stamps = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
            order = np.lexsort((stamps, keys))
            keys, stamps = keys[order], stamps[order]
            last = np.append(keys[1:] != keys[:-1], True) if len(keys) else np.zeros(0, dtype=bool)
            covers[free] = keys[last], stamps[last]
        return covers

    def _covered(
        self, keys: np.ndarray, stamps: np.ndarray, free: int, covers: dict[int, tuple[np.ndarray, np.ndarray]]
    ) -> np.ndarray:
        """Which boxes (with these free axes) lie within one that was filled later."""
        covered = np.zeros(len(keys), dtype=bool)
        for other, (boxes, times) in covers.items():
            if other & free != free or not len(boxes):
                continue
            projected = keys.copy()
            for axis in range(len(self.shape)):
                if other >> axis & 1:
                    projected -= keys // self.strides[axis] % self.shape[axis] * self.strides[axis]
            found = np.minimum(np.searchsorted(boxes, projected), len(boxes) - 1)
            covered |= (boxes[found] == projected) & (times[found] > stamps)
        return covered

    def _expanded(
        self, axes: tuple[int, ...], covers: dict[int, tuple[np.ndarray, np.ndarray]]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places, numbers and stamps of all that is not zero, of boxes that hold (points may be zero)."""
        parts: list[tuple[np.ndarray, np.ndarray, np.ndarray, int]] = []
        total = 0
        for free, column in self._columns.items():
            keys, numbers, stamps = column.arrays()
            holds = ~self._covered(keys, stamps, free, covers)
            if free:
                holds &= numbers != 0
            parts.append((keys[holds], numbers[holds], stamps[holds], free))
            total += int(holds.sum()) * self._extent(free, axes)
        for free, same in self._by_pattern().items():
            keys = np.array([block.key for block in same], dtype=np.int64)
            stamps = np.array([block.stamp for block in same], dtype=np.int64)
            for block, gone in zip(same, self._covered(keys, stamps, free, covers), strict=True):
                if not gone:
                    total += block.count * self._extent(free & ~block.along, axes)
                    self._refuse_if_large(total)
                    offsets, numbers = block.laid_out()
                    times = np.full(len(offsets), block.stamp, dtype=np.int64)
                    parts.append((block.key + offsets, numbers, times, free & ~block.along))
        self._refuse_if_large(total)
        made = [self._spread(*part, axes) for part in parts]
        return tuple(np.concatenate(arrays) for arrays in zip(*made, strict=True))  # type: ignore[return-value]

    def _by_pattern(self) -> dict[int, list[_Block]]:
        found: dict[int, list[_Block]] = {}
        for block in self._blocks:
            found.setdefault(block.free, []).append(block)
        return found

    def _refuse_if_large(self, total: int) -> None:
        if total > MOST_ENTRIES:
            raise TooLarge(f"{total:,} entries or more that are not zero; {MOST_ENTRIES:,} are allowed")

    def _extent(self, free: int, axes: tuple[int, ...]) -> int:
        return math.prod(self.shape[axis] for axis in axes if free >> axis & 1)

    def _spread(
        self, keys: np.ndarray, numbers: np.ndarray, stamps: np.ndarray, free: int, axes: tuple[int, ...]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not len(keys):
            return keys, numbers, stamps
        offsets = np.zeros(1, dtype=np.int64)
        for axis in axes:
            if free >> axis & 1:
                steps = np.arange(self.shape[axis], dtype=np.int64) * self.strides[axis]
                offsets = (offsets[:, None] + steps).ravel()
        spread = (keys[:, None] + offsets).ravel()
        return spread, np.repeat(numbers, len(offsets)), np.repeat(stamps, len(offsets))
