"""A function given as ``TBL``: entries of an instance and its numbers.

Of an instance's words, a value's name fixes a variable, ``*`` says that the numbers hold for all of its values, and
``-`` that the numbers run over them (row-major). ``uniform`` spreads the probability evenly over the function's own
variables, ``identity`` is one where the last two ``-`` agree. Later entries hold over earlier ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.pomdpx.tree import Element, Lines
from factored_pomdp.files.values import all_numbers, lookup, near
from factored_pomdp.variables import Variable

__all__ = ["read_table"]

_MOST_WORDS = 10_000
"""Words that are told apart where fewer would be right."""


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
    many: list[tuple[list[int], float, int]] = []
    for entry in parameter.children:
        if faults.full:
            return
        stamp = lines.stamp(entry.line)
        if entry.tag != "Entry":
            faults.note(stamp, "<Parameter type='TBL'>", f"<{entry.tag}>", "<Entry>")
            layers.doubts.add_everything(stamp)
            continue
        instance, table = entry.first("Instance"), entry.first("ProbTable") or entry.first("ValueTable")
        if instance is None or table is None:
            layers.doubts.add_everything(stamp, certain=False)
            if not entry.foreign:
                expected = "an <Instance>, and a <ProbTable> or <ValueTable>"
                faults.note(stamp, "<Entry>", "no <Instance> or no table", expected)
            continue
        words = instance.text.split(maxsplit=_MOST_WORDS)
        coordinates = _coordinates(words, positions, scope, stamp, faults)
        if coordinates is None:
            doubted = [known.get(word, -1) for word, known in zip(words, positions, strict=False)]
            same = len(words) == len(scope)
            layers.doubts.add(doubted if same else [-1] * len(scope), stamp, certain=False)
            continue
        number = _one_number(table.text) if "-" not in words else None
        if number is not None:
            many.append((coordinates, number, stamp))
        else:
            along = [axis for axis, word in enumerate(words) if word == "-"] if scope else []
            before = len(faults)
            _lay(layers, coordinates, along, table, scope, children, stamp, faults)
            if len(faults) > before:
                layers.doubts.add(coordinates, stamp)
    if many:
        places, numbers, stamps = zip(*many, strict=True)
        layers.scalars(np.array(places, dtype=np.int64).reshape(len(many), -1), np.array(numbers), np.array(stamps))


def _coordinates(
    words: list[str],
    positions: Sequence[dict[str, int]],
    scope: Sequence[Variable],
    stamp: int,
    faults: FaultList,
) -> list[int] | None:
    """Positions of an instance's values, -1 for ``*`` and ``-``; ``None`` after a fault was noted."""
    if not scope and words in (["-"], ["*"], ["null"]):
        return []
    if len(words) != len(scope):
        names = " ".join(variable.name for variable in scope)
        faults.note(stamp, "<Instance>", f"{len(words)} words", f"{len(scope)}, one for each of: {names}")
        return None
    found = []
    for word, known, variable in zip(words, positions, scope, strict=True):
        if word not in known:
            expected = f"a value of {variable.name}, * or -{near(word, variable.values)}"
            faults.note(stamp, "<Instance>", shortened(word), expected)
            return None
        found.append(known[word])
    return found


def _one_number(text: str) -> float | None:
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None


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
    expected = math.prod(scope[axis].size for axis in along)
    words = text.split(maxsplit=max(expected, _MOST_WORDS))
    surplus = len(words) > max(expected, _MOST_WORDS)
    numbers = np.zeros(0) if surplus else all_numbers(words)
    if numbers is None:
        wrong = next(word for word in words if all_numbers([word]) is None)
        faults.note(stamp, where, shortened(wrong), "finite numbers")
    elif len(numbers) != expected:
        shape = " × ".join(str(scope[axis].size) for axis in along)
        needed = f"{expected:,} ({shape} for the - of the instance)" if along else "1, as the instance holds no -"
        found = f"more than {len(words) - 1:,} numbers" if surplus else f"{len(numbers):,} numbers"
        faults.note(stamp, where, found, needed)
    elif along:
        layers.array(coordinates, along, np.asarray(numbers), stamp)
    else:
        layers.scalar(coordinates, float(numbers[0]), stamp)
