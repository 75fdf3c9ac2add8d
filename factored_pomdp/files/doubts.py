"""Places of a table of which nobody can tell what the file means, as a statement about them could not be read."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

__all__ = ["Doubts"]


@dataclass
class Doubts:
    """Boxes that statements with faults were about.

    Faults of the numbers in a table are looked for even where some of its statements could not be read; what may be a
    mere consequence of those is left out.

    Attributes
    ----------
    shape : tuple of int
        Sizes of the table's axes.
    boxes : dict
        The last stamp for each box: its coordinates (-1 for all values), and whether the statement is about the box for
        certain (it is not where a name was not known, and any value may have been meant).
    """

    shape: tuple[int, ...]
    boxes: dict[tuple[tuple[int, ...], bool], int] = field(default_factory=dict)

    def add(self, coordinates: Sequence[int], stamp: int, *, certain: bool = True) -> None:
        """Doubt a box."""
        box = tuple(coordinates), certain
        self.boxes[box] = max(stamp, self.boxes.get(box, stamp))

    def add_everything(self, stamp: int, *, certain: bool = True) -> None:
        """Doubt the whole table."""
        self.add([-1] * len(self.shape), stamp, certain=certain)

    def __len__(self) -> int:
        return len(self.boxes)

    @property
    def axes(self) -> list[int]:
        """The axes along which some places are doubted and others are not."""
        return sorted({axis for box, _ in self.boxes for axis, position in enumerate(box) if position >= 0})

    def rows(self, axes: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Of each row: whether it is doubted at all, and the last stamp of what is about it for certain (-1: none).

        Parameters
        ----------
        axes : sequence of int
            Those by which rows are told apart.

        Returns
        -------
        touched, since : (rows,) arrays
            Row-major. Time grows with the rows, not with rows times boxes: equal boxes count once.
        """
        shape = [self.shape[axis] for axis in axes]
        touched, since = np.zeros(shape, dtype=bool), np.full(shape, -1, dtype=np.int64)
        last: dict[tuple[tuple[int, ...], bool], int] = {}
        for (box, certain), stamp in self.boxes.items():
            key = tuple(box[axis] for axis in axes), certain
            last[key] = max(stamp, last.get(key, stamp))
        for (row, certain), stamp in last.items():
            index = tuple(slice(None) if position < 0 else slice(position, position + 1) for position in row)
            touched[index] = True
            if certain:
                since[index] = np.maximum(since[index], stamp)
        return touched.ravel(), since.ravel()
