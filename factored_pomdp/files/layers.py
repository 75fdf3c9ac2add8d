"""A table written in layers, as both file formats do it: what is said later holds, and ``*`` stands for every value.

Each statement fills a box: some coordinates are fixed, the others run over all values. Boxes are not laid out as they
come (``T: * : * : * 0.0`` over 10,000 states would be a billion numbers), but once, when all has been said: only the
entries that are not zero are made, and those that a later box covers are dropped. Time n log n in the entries that are
made, for each of the few patterns of fixed coordinates.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from functools import reduce
from operator import or_

import numpy as np

from factored_pomdp.errors import TooLarge
from factored_pomdp.files.boxes import Block, Column, Entries
from factored_pomdp.files.defaults import Piece, cheapest_base, looked_up
from factored_pomdp.files.doubts import Doubts

__all__ = ["MOST_ENTRIES", "Layers"]

MOST_ENTRIES = 20_000_000
"""Entries that one table of a file may have."""

_WIDEST = 2**62

_Covers = dict[int, tuple[np.ndarray, np.ndarray]]
"""For each set of free axes, keys of boxes in order, and when each was last filled."""


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
        self._columns: dict[int, Column] = {0: Column()}
        self._blocks: list[Block] = []
        self.doubts = Doubts(self.shape)

    def scalar(self, coordinates: Sequence[int], number: float, stamp: int) -> None:
        """One number for a whole box."""
        key, free = self._place(coordinates)
        column = self._columns.setdefault(free, Column())
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
            self._columns.setdefault(free, Column()).many.append((keys[same], numbers[same], stamps[same]))

    def array(self, coordinates: Sequence[int], along: Sequence[int], numbers: np.ndarray, stamp: int) -> None:
        """Numbers along some free axes (in order, row-major), the same for all values of the other free ones."""
        key, free = self._place(coordinates)
        flat = np.flatnonzero(numbers)
        offsets = np.zeros(len(flat), dtype=np.int64)
        within = flat
        for axis in reversed(along):
            offsets += within % self.shape[axis] * self.strides[axis]
            within = within // self.shape[axis]
        self._blocks.append(
            Block(free, sum(1 << axis for axis in along), key, stamp, offsets, np.asarray(numbers)[flat])
        )

    def diagonal(self, coordinates: Sequence[int], along: tuple[int, int], stamp: int) -> None:
        """One where two free axes of the same size agree, and zero elsewhere."""
        key, free = self._place(coordinates)
        first, second = along
        step = self.strides[first] + self.strides[second]
        self._blocks.append(Block(free, 1 << first | 1 << second, key, stamp, None, None, (self.shape[first], step)))

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
        return self._listed(axes, *self._last(axes, self._covers()))

    def base_and_differences(self) -> tuple[Entries, Entries]:
        """What the table holds as a sum of two (`factored_pomdp.files.defaults`).

        Returns
        -------
        base : Entries
            Over those axes for which the fewest entries are made.
        differences : Entries
            What the table holds, less the base.

        Raises
        ------
        TooLarge
            Beyond `MOST_ENTRIES` even so, before they are made.
        """
        covers = self._covers()
        pieces = self._pieces(covers)
        chosen, total = cheapest_base(pieces, self.shape)
        self._refuse_if_large(total)
        within, others = self._part(chosen, within=True), self._part(chosen, within=False)
        axes = tuple(self._listed_axes(chosen))
        base = within._last(axes, within._covers())
        around = tuple(self._listed_axes(reduce(or_, (piece.axes for piece in pieces), chosen)))
        keys, numbers, stamps = others._last(around, covers, zeros=True)
        numbers = numbers - looked_up(*base[:2], self._first(keys, self._fixed(chosen)))
        return self._listed(axes, *base), self._listed(around, keys, numbers, stamps)

    def has_wide_numbers(self) -> bool:
        """Whether numbers other than zero, each for many places, alone may make up too many entries."""
        used = self._used
        made = (
            int(np.count_nonzero(column.arrays()[1])) * self._extent(free & used)
            for free, column in self._columns.items()
            if free
        )
        return sum(made) > MOST_ENTRIES

    def _listed(self, axes: tuple[int, ...], keys: np.ndarray, numbers: np.ndarray, stamps: np.ndarray) -> Entries:
        """Of entries in order, those that are not zero."""
        holds = numbers != 0
        keys = keys[holds]
        columns = [keys // self.strides[axis] % self.shape[axis] for axis in axes]
        coordinates = np.stack(columns, axis=1) if axes else np.zeros((len(keys), 0), dtype=np.int64)
        return Entries(axes, coordinates, numbers[holds], stamps[holds])

    def _part(self, axes: int, *, within: bool) -> Layers:
        """The statements whose numbers depend on some axes alone, or all the others."""
        part = Layers(self.shape)
        chosen = {f: column for f, column in self._columns.items() if (not self._fixed(f) & ~axes) == within}
        part._columns |= chosen
        part._blocks = [block for block in self._blocks if (not self._about(block) & ~axes) == within]
        return part

    def _pieces(self, covers: _Covers) -> list[Piece]:
        """How many numbers those statements may give that no later box covers, by the axes on which they depend."""
        places: Counter[int] = Counter()
        numbers: Counter[int] = Counter()
        for free, column in self._columns.items():
            keys, said, stamps = column.arrays()
            places[self._fixed(free)] += len(keys) - int(self._covered(keys, stamps, free, covers).sum())
            numbers[self._fixed(free)] += int(np.count_nonzero(said))
        for block, gone in self._with_fate(covers):
            places[self._about(block)] += 0 if gone else self._extent(block.along)
            numbers[self._about(block)] += block.count
        return [Piece(axes, places[axes], numbers[axes]) for axes in places if places[axes]]

    def _fixed(self, free: int) -> int:
        return (1 << len(self.shape)) - 1 & ~free

    def _about(self, block: Block) -> int:
        return self._fixed(block.free) | block.along

    def _place(self, coordinates: Sequence[int]) -> tuple[int, int]:
        key = free = 0
        for axis, position in enumerate(coordinates):
            if position < 0:
                free |= 1 << axis
            else:
                key += position * self.strides[axis]
        return key, free

    @property
    def _used(self) -> int:
        """Axes on which anything depends."""
        used = 0
        for free, column in self._columns.items():
            used |= self._fixed(free) if len(column) else 0
        for block in self._blocks:
            used |= self._about(block)
        return used

    def _axes(self, keep: Sequence[int]) -> tuple[int, ...]:
        used = self._used
        return tuple(axis for axis in range(len(self.shape)) if used >> axis & 1 or axis in keep)

    def _covers(self) -> _Covers:
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

    def _covered(self, keys: np.ndarray, stamps: np.ndarray, free: int, covers: _Covers) -> np.ndarray:
        """Which boxes (with these free axes) lie within one that was filled later."""
        covered = np.zeros(len(keys), dtype=bool)
        for other, (boxes, times) in covers.items():
            if other & free != free or not len(boxes):
                continue
            projected = self._first(keys, other)
            found = np.minimum(np.searchsorted(boxes, projected), len(boxes) - 1)
            covered |= (boxes[found] == projected) & (times[found] > stamps)
        return covered

    def _first(self, keys: np.ndarray, free: int) -> np.ndarray:
        """Keys of the boxes with these free axes around some places."""
        first = keys.copy()
        for axis in self._listed_axes(free):
            first -= keys // self.strides[axis] % self.shape[axis] * self.strides[axis]
        return first

    def _last(
        self, axes: tuple[int, ...], covers: _Covers, *, zeros: bool = False
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places, in order, with the number and the stamp that hold: where statements say a number but zero, or any."""
        keys, numbers, stamps = self._expanded(sum(1 << axis for axis in axes), covers, zeros=zeros)
        order = np.lexsort((stamps, keys))
        keys, numbers, stamps = keys[order], numbers[order], stamps[order]
        last = np.append(keys[1:] != keys[:-1], True) if len(keys) else np.zeros(0, dtype=bool)
        keys, numbers, stamps = keys[last], numbers[last], stamps[last]
        holds = ~self._covered(keys, stamps, 0, covers)
        return keys[holds], numbers[holds], stamps[holds]

    def _expanded(self, axes: int, covers: _Covers, *, zeros: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Places, numbers and stamps of boxes that hold: of all that is not zero (points may be zero), or of all."""
        parts: list[tuple[np.ndarray, np.ndarray, np.ndarray, int]] = []
        total = 0
        for free, column in self._columns.items():
            keys, numbers, stamps = column.arrays()
            holds = ~self._covered(keys, stamps, free, covers)
            if free and not zeros:
                holds &= numbers != 0
            parts.append((keys[holds], numbers[holds], stamps[holds], free))
            total += int(holds.sum()) * self._extent(free & axes)
        for block, gone in self._with_fate(covers):
            if not gone:
                left = block.free & ~block.along
                total += (self._extent(block.along) if zeros else block.count) * self._extent(left & axes)
                self._refuse_if_large(total)
                offsets, numbers = block.laid_out()
                if zeros:
                    places = self._offsets(block.along)
                    offsets, numbers = places, looked_up(offsets, numbers, places)
                times = np.full(len(offsets), block.stamp, dtype=np.int64)
                parts.append((block.key + offsets, numbers, times, left))
        self._refuse_if_large(total)
        made = [self._spread(keys, numbers, stamps, free & axes) for keys, numbers, stamps, free in parts]
        return tuple(np.concatenate(arrays) for arrays in zip(*made, strict=True))  # type: ignore[return-value]

    def _with_fate(self, covers: _Covers) -> Iterator[tuple[Block, bool]]:
        """Blocks, and whether a later box covers them."""
        for free, same in self._by_pattern().items():
            keys = np.array([block.key for block in same], dtype=np.int64)
            stamps = np.array([block.stamp for block in same], dtype=np.int64)
            yield from zip(same, self._covered(keys, stamps, free, covers).tolist(), strict=True)

    def _by_pattern(self) -> dict[int, list[Block]]:
        found: dict[int, list[Block]] = {}
        for block in self._blocks:
            found.setdefault(block.free, []).append(block)
        return found

    def _refuse_if_large(self, total: int) -> None:
        if total > MOST_ENTRIES:
            raise TooLarge(f"{total:,} entries or more that are not zero; {MOST_ENTRIES:,} are allowed")

    def _spread(
        self, keys: np.ndarray, numbers: np.ndarray, stamps: np.ndarray, free: int
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        if not len(keys):
            return keys, numbers, stamps
        offsets = self._offsets(free)
        spread = (keys[:, None] + offsets).ravel()
        return spread, np.repeat(numbers, len(offsets)), np.repeat(stamps, len(offsets))

    def _offsets(self, axes: int) -> np.ndarray:
        """From the first place of a box to each of its places, in order."""
        offsets = np.zeros(1, dtype=np.int64)
        for axis in self._listed_axes(axes):
            steps = np.arange(self.shape[axis], dtype=np.int64) * self.strides[axis]
            offsets = (offsets[:, None] + steps).ravel()
        return offsets

    def _extent(self, axes: int) -> int:
        return math.prod(self.shape[axis] for axis in self._listed_axes(axes))

    def _listed_axes(self, axes: int) -> list[int]:
        return [axis for axis in range(len(self.shape)) if axes >> axis & 1]
