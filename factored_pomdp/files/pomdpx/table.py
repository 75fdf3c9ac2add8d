"""A function given as ``TBL``: entries of an instance and its numbers.

Of an instance's words, a value's name fixes a variable, ``*`` says that the numbers hold for all of its values, and
``-`` that the numbers run over them (row-major). ``uniform`` spreads the probability evenly over the function's own
variables, ``identity`` is one where the last two ``-`` agree. Later entries hold over earlier ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from factored_pomdp.errors import did_you_mean
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.pomdpx.tree import Element, Lines
from factored_pomdp.files.values import all_numbers, lookup
from factored_pomdp.variables import Variable

__all__ = ["read_table"]


def read_table(
    parameter: Element,
    layers: Layers,
    scope: Sequence[Variable],
    children: Sequence[Variable],
    lines: Lines,
    faults: FaultList,
) -> None:
    """Lay a table's entries into ``layers``, whose axes are ``scope``; ``children`` is empty for a reward."""
    positions = [lookup(variable) | {"*": -1, "-": -1} for variable in scope]
    for entry in parameter.children:
        if faults.full:
            return
        if entry.tag != "Entry":
            faults.note(lines.stamp(entry.line), "<Parameter type='TBL'>", f"<{entry.tag}>", "<Entry>")
            continue
        instance, table = entry.first("Instance"), entry.first("ProbTable") or entry.first("ValueTable")
        stamp = lines.stamp(entry.line)
        if instance is None or table is None:
            faults.note(
                stamp, "<Entry>", "no <Instance> or no table", "an <Instance>, and a <ProbTable> or <ValueTable>"
            )
            continue
        words = instance.text.split()
        if not scope and words in ([], ["-"], ["*"], ["null"]):
            words = []
        if len(words) != len(scope):
            names = " ".join(variable.name for variable in scope)
            faults.note(stamp, "<Instance>", f"{len(words)} words", f"{len(scope)}, one for each of: {names}")
            continue
        coordinates = [found.get(word) for found, word in zip(positions, words, strict=True)]
        if None in coordinates:
            axis = coordinates.index(None)
            expected = f"a value of {scope[axis].name}, * or -{did_you_mean(words[axis], scope[axis].values)}"
            faults.note(stamp, "<Instance>", shortened(words[axis]), expected)
            continue
        along = [axis for axis, word in enumerate(words) if word == "-"]
        _lay(layers, [c for c in coordinates if c is not None], along, table, scope, children, stamp, faults)


def _lay(
    layers: Layers,
    coordinates: list[int],
    along: list[int],
    table: Element,
    scope: Sequence[Variable],
    children: Sequence[Variable],
    stamp: int,
    faults: FaultList,
) -> None:
    text = table.text.strip()
    where = f"<{table.tag}>"
    if text.lower() == "uniform" and children:
        layers.scalar(coordinates, 1 / math.prod(child.size for child in children), stamp)
        return
    if text.lower() == "identity":
        if len(along) >= 2 and scope[along[-2]].size == scope[along[-1]].size:
            layers.diagonal(coordinates, (along[-2], along[-1]), stamp)
        else:
            faults.note(stamp, where, "identity", "identity only where two - of the same size stand in the instance")
        return
    words = text.split()
    numbers = all_numbers(words)
    expected = math.prod(scope[axis].size for axis in along)
    if numbers is None:
        wrong = next(word for word in words if all_numbers([word]) is None)
        faults.note(stamp, where, shortened(wrong), "finite numbers")
    elif len(numbers) != expected:
        shape = " × ".join(str(scope[axis].size) for axis in along)
        needed = f"{expected:,} ({shape} for the - of the instance)" if along else "1, as the instance holds no -"
        faults.note(stamp, where, f"{len(numbers):,} numbers", needed)
    elif along:
        layers.array(coordinates, along, np.asarray(numbers), stamp)
    else:
        layers.scalar(coordinates, float(numbers[0]), stamp)
