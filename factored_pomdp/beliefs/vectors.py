"""The innermost step of a prediction: a weighted sum of rows, added up in the processor's vector registers.

Compiled loops over rows of some twenty numbers spend most of their time on entering and leaving the inner loop, and on
storing sums that the next entry loads again. So this step is given to the compiler as vector instructions: as many
columns as fit into eight registers of four numbers are summed over all the entries, and stored once. Where a processor
has shorter registers, the compiler takes several for one. Nothing is fused or reordered: a column's sum has the same
bits wherever it stands.
"""

from __future__ import annotations

from typing import Any, no_type_check

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

__all__ = ["LANES", "MOST_COLUMNS", "weighted_rows"]

LANES = 4
MOST_COLUMNS = 8 * LANES
"""Columns that one call sums at the most: eight registers of sums leave some of sixteen for what is read."""


@intrinsic(prefer_literal=True)
@no_type_check
def weighted_rows(
    typing_context: Any,
    weights: Any,
    rows: Any,
    first: Any,
    last: Any,
    table: Any,
    table_at: Any,
    result: Any,
    result_at: Any,
    columns: Any,
    shape: Any,
) -> Any:
    """``result[result_at + j] = Σ_e weights[e] · table[rows[e], table_at + j]`` for entries ``first ≤ e < last``.

    Parameters
    ----------
    weights, rows : (entries,) float, int
    table : (rows, width) float, C-contiguous
    result : float, C-contiguous
        Written at flat positions ``result_at`` to ``result_at + columns``.
    shape : literal int
        How many vectors hold the columns: ``n`` vectors of `LANES` for ``n > 0``, the last of which overlaps the one
        before where they do not divide evenly; ``-n`` vectors of one number for ``n < 0``, where there are too few
        columns for one vector.
    """
    lanes = LANES if shape.literal_value > 0 else 1
    vectors = abs(shape.literal_value)
    signature = types.void(
        weights, rows, types.intp, types.intp, table, types.intp, result, types.intp, types.intp, shape
    )

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        weight_array, row_array, table_array, result_array = (
            context.make_array(signature.args[n])(context, builder, arguments[n]) for n in (0, 1, 4, 6)
        )
        first, last, table_at, result_at, columns = (arguments[n] for n in (2, 3, 5, 7, 8))
        integer = first.type
        vector = ir.VectorType(ir.DoubleType(), lanes)
        undefined = ir.Constant(vector, ir.Undefined)
        same = ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes)
        starts = [ir.Constant(integer, lanes * n) for n in range(vectors - 1)]
        starts.append(builder.sub(columns, ir.Constant(integer, lanes)))
        sums = [cgutils.alloca_once_value(builder, ir.Constant(vector, [0.0] * lanes)) for _ in starts]
        for total in sums:
            builder.store(ir.Constant(vector, [0.0] * lanes), total)
        width = builder.extract_value(table_array.shape, 1)

        def place(array: Any, at: Any) -> Any:
            return builder.bitcast(builder.gep(array.data, [at]), vector.as_pointer())

        with cgutils.for_range_slice(builder, first, last, ir.Constant(integer, 1)) as (entry, _):
            row = builder.load(builder.gep(row_array.data, [entry]))
            row = context.cast(builder, row, signature.args[1].dtype, types.intp)
            weight = builder.load(builder.gep(weight_array.data, [entry]))
            weight = builder.insert_element(undefined, weight, ir.Constant(ir.IntType(32), 0))
            weight = builder.shuffle_vector(weight, undefined, same)
            row_at = builder.add(builder.mul(row, width), table_at)
            for start, total in zip(starts, sums, strict=True):
                numbers = builder.load(place(table_array, builder.add(row_at, start)), align=8)
                builder.store(builder.fadd(builder.load(total), builder.fmul(weight, numbers)), total)
        for start, total in zip(starts, sums, strict=True):
            builder.store(builder.load(total), place(result_array, builder.add(result_at, start)), align=8)
        return context.get_dummy_value()

    return signature, generate
