"""A reward that is too large as one table: a *base* over few variables and a sparse table of differences from it.

``R: * : * : * : * -1`` with ten exceptions is one number and ten, but as one table it is a number for every place. The
two together are the same reward, as the rewards of a model are summed (but for the rounding of one subtraction).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from factored_pomdp.factors import Factor

__all__ = ["Piece", "as_terms", "cheapest_base", "looked_up"]

_MOST_CANDIDATES = 1_024


def as_terms(name: str, parts: Sequence[Factor], taken: Collection[str] = ()) -> dict[str, Factor]:
    """A reward's one or two parts as rewards of a model: the second is called the exceptions.

    Parameters
    ----------
    taken : collection of str
        Names of other rewards.
    """
    second = f"{name}_exceptions"
    while second in taken:
        second += "_"
    return dict(zip((name, second), parts, strict=False))


@dataclass(frozen=True)
class Piece:
    """A part of a table.

    Attributes
    ----------
    axes : int
        Those on which its numbers depend, as a mask.
    places : int
        Over those axes, places of which it says a number.
    numbers : int
        Those among them where the number may be other than zero.
    """

    axes: int
    places: int
    numbers: int


def cheapest_base(pieces: Sequence[Piece], shape: Sequence[int]) -> tuple[int, int]:
    """The axes (a mask) of the base that leaves the fewest entries in all, and how many these may be.

    The base takes every piece that depends on its axes alone; what the others say becomes differences from it, over
    their axes and the base's. Where two come to the same number, the smaller mask is taken.

    Parameters
    ----------
    shape : sequence of int
        Sizes of the axes.
    """
    candidates = {0}
    for axes in dict.fromkeys(piece.axes for piece in sorted(pieces, key=lambda piece: -piece.places)):
        candidates |= {axes | other for other in candidates}
        if len(candidates) > _MOST_CANDIDATES:
            break
    entries, base = min((_entries(base, pieces, shape), base) for base in candidates)
    return base, entries


def looked_up(
    keys: Int[np.ndarray, " known"], numbers: Float[np.ndarray, " known"], wanted: Int[np.ndarray, " places"]
) -> Float[np.ndarray, " places"]:
    """Numbers of the wanted keys, zero for those that are not known; ``keys`` in growing order."""
    if not len(keys):
        return np.zeros(len(wanted))
    found = np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)
    return np.where(keys[found] == wanted, numbers[found], 0.0)


def _entries(base: int, pieces: Sequence[Piece], shape: Sequence[int]) -> int:
    within = [piece for piece in pieces if not piece.axes & ~base]
    others = [piece for piece in pieces if piece.axes & ~base]
    axes = base
    for piece in others:
        axes |= piece.axes
    most = sum(piece.numbers * _extent(base & ~piece.axes, shape) for piece in within)
    return min(most, _extent(base, shape)) + sum(piece.places * _extent(axes & ~piece.axes, shape) for piece in others)


def _extent(axes: int, shape: Sequence[int]) -> int:
    return math.prod(size for axis, size in enumerate(shape) if axes >> axis & 1)
