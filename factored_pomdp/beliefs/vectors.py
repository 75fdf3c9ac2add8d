"""Rows of numbers in the processor's vector registers: the innermost steps of prediction and conditioning.

Compiled loops over rows of some twenty numbers spend most of their time on entering and leaving the inner loop, and on
storing sums that the next entry loads again. So these steps are given to the compiler as vector instructions: as many
columns as fit into eight registers of four numbers go through all the rows together. Where a processor has shorter
registers, the compiler takes several for one. Nothing is fused or reordered: a column's numbers have the same bits
wherever it stands.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple, no_type_check

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

__all__ = ["Tile", "product_rows", "product_sums", "tiles", "weighted_rows"]

_LANES = 4
_MOST_COLUMNS = 8 * _LANES
"""Columns that go together at the most: eight registers of sums leave some of sixteen for what is read."""


class Tile(NamedTuple):
    """Some neighbouring columns of a table.

    Attributes
    ----------
    first, columns : int
    shape : int
        What holds them: ``n`` vectors of four numbers for ``n > 0``, the last of which overlaps the one before where
        the columns do not divide evenly; ``-n`` single numbers for ``n < 0``, where there are too few for one vector.
    """

    first: int
    columns: int
    shape: int


@lru_cache(maxsize=256)
def tiles(columns: int) -> tuple[Tile, ...]:
    """Columns in tiles of about equal width."""
    number = -(-columns // _MOST_COLUMNS)
    widths = [columns // number + (n < columns % number) for n in range(number)]
    shapes = [-(-width // _LANES) if width >= _LANES else -width for width in widths]
    return tuple(Tile(sum(widths[:n]), widths[n], shapes[n]) for n in range(number))


@intrinsic(prefer_literal=True)
@no_type_check
def weighted_rows(
    typing: Any,
    weights: Any,
    rows: Any,
    first: Any,
    last: Any,
    table: Any,
    at: Any,
    result: Any,
    to: Any,
    columns: Any,
    shape: Any,
) -> Any:
    """``result[to + j] = Σ_e weights[e] · table[rows[e], at + j]`` for the entries ``first ≤ e < last``.

    ``table`` and ``result`` are C-contiguous; ``to`` is a position in the flat result, ``shape`` that of a `Tile`.
    """
    integer = types.intp
    signature = types.void(weights, rows, integer, integer, table, integer, result, integer, integer, shape)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        _, _, first, last, _, at, _, to, columns, _ = arguments
        lay = _Layout(context, builder, signature, arguments)
        weights, rows, table, result = lay.array(0), lay.array(1), lay.array(4), lay.array(6)
        starts = lay.starts(columns, shape.literal_value)
        sums = [lay.zero() for _ in starts]
        with cgutils.for_range_slice(builder, first, last, lay.integer(1)) as (entry, _):
            weight = lay.spread(builder.load(builder.gep(weights.data, [entry])))
            begin = builder.add(lay.row(table, lay.index(1, rows, entry)), at)
            for start, total in zip(starts, sums, strict=True):
                numbers = lay.load(table, builder.add(begin, start))
                builder.store(builder.fadd(builder.load(total), builder.fmul(weight, numbers)), total)
        for start, total in zip(starts, sums, strict=True):
            lay.store(builder.load(total), result, builder.add(to, start))
        return context.get_dummy_value()

    return signature, generate


@intrinsic(prefer_literal=True)
@no_type_check
def product_sums(typing: Any, table: Any, rows: Any, other: Any, result: Any, at: Any, columns: Any, shape: Any) -> Any:
    """``result[at + j] = Σ_i table[i, at + j] · other[rows[i], at + j]``; arrays C-contiguous."""
    signature = types.void(table, rows, other, result, types.intp, types.intp, shape)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        at, columns = arguments[4:6]
        lay = _Layout(context, builder, signature, arguments)
        table, rows, other, result = (lay.array(n) for n in range(4))
        starts = lay.starts(columns, shape.literal_value)
        sums = [lay.zero() for _ in starts]
        with cgutils.for_range(builder, builder.extract_value(table.shape, 0)) as loop:
            here = builder.add(lay.row(table, loop.index), at)
            there = builder.add(lay.row(other, lay.index(1, rows, loop.index)), at)
            for start, total in zip(starts, sums, strict=True):
                pair = [lay.load(table, builder.add(here, start)), lay.load(other, builder.add(there, start))]
                builder.store(builder.fadd(builder.load(total), builder.fmul(*pair)), total)
        for start, total in zip(starts, sums, strict=True):
            lay.store(builder.load(total), result, builder.add(at, start))
        return context.get_dummy_value()

    return signature, generate


@intrinsic(prefer_literal=True)
@no_type_check
def product_rows(typing: Any, table: Any, rows: Any, other: Any, result: Any, at: Any, columns: Any, shape: Any) -> Any:
    """``result[i, at + j] = table[i, at + j] · other[rows[i], at + j]``; arrays C-contiguous."""
    signature = types.void(table, rows, other, result, types.intp, types.intp, shape)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        at, columns = arguments[4:6]
        lay = _Layout(context, builder, signature, arguments)
        table, rows, other, result = (lay.array(n) for n in range(4))
        starts = lay.starts(columns, shape.literal_value)
        with cgutils.for_range(builder, builder.extract_value(table.shape, 0)) as loop:
            here = builder.add(lay.row(table, loop.index), at)
            there = builder.add(lay.row(other, lay.index(1, rows, loop.index)), at)
            for start in starts:
                pair = [lay.load(table, builder.add(here, start)), lay.load(other, builder.add(there, start))]
                lay.store(builder.fmul(*pair), result, builder.add(here, start))
        return context.get_dummy_value()

    return signature, generate


class _Layout:
    """Instructions that the three have in common."""

    def __init__(self, context: Any, builder: Any, signature: Any, arguments: Any) -> None:
        self._context, self._builder, self._types, self._arguments = context, builder, signature.args, arguments
        shape = signature.args[-1].literal_value
        self._lanes = _LANES if shape > 0 else 1
        self._vector = ir.VectorType(ir.DoubleType(), self._lanes)

    def integer(self, number: int) -> Any:
        return ir.Constant(self._context.get_value_type(types.intp), number)

    def array(self, position: int) -> Any:
        """An argument's data and shape."""
        return self._context.make_array(self._types[position])(self._context, self._builder, self._arguments[position])

    def starts(self, columns: Any, shape: int) -> list[Any]:
        """Where each vector begins; the last one ends with the columns."""
        firsts = [self.integer(self._lanes * n) for n in range(abs(shape) - 1)]
        return [*firsts, self._builder.sub(columns, self.integer(self._lanes))]

    def zero(self) -> Any:
        """A vector of zeros, in a place that becomes a register."""
        return cgutils.alloca_once_value(self._builder, ir.Constant(self._vector, [0.0] * self._lanes))

    def spread(self, number: Any) -> Any:
        """One number in all the places of a vector."""
        undefined = ir.Constant(self._vector, ir.Undefined)
        alone = self._builder.insert_element(undefined, number, ir.Constant(ir.IntType(32), 0))
        same = ir.Constant(ir.VectorType(ir.IntType(32), self._lanes), [0] * self._lanes)
        return self._builder.shuffle_vector(alone, undefined, same)

    def index(self, position: int, array: Any, at: Any) -> Any:
        """An element of an array of integers of any width."""
        number = self._builder.load(self._builder.gep(array.data, [at]))
        return self._context.cast(self._builder, number, self._types[position].dtype, types.intp)

    def row(self, array: Any, number: Any) -> Any:
        """Position of a row's first element."""
        return self._builder.mul(number, self._builder.extract_value(array.shape, 1))

    def load(self, array: Any, at: Any) -> Any:
        return self._builder.load(self._place(array, at), align=8)

    def store(self, vector: Any, array: Any, at: Any) -> None:
        self._builder.store(vector, self._place(array, at), align=8)

    def _place(self, array: Any, at: Any) -> Any:
        return self._builder.bitcast(self._builder.gep(array.data, [at]), self._vector.as_pointer())
