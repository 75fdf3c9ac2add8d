"""Blocks of one shape: the same scopes up to names. A picture draws each shape once, in a plate."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

from factored_pomdp.beliefs.stacks import stacks_of
from factored_pomdp.factors import Factor
from factored_pomdp.structure import Block

__all__ = ["Shape", "dependences", "shapes_of"]


@dataclass(frozen=True)
class Shape:
    """Blocks that look alike.

    Attributes
    ----------
    pattern : Block
        The first of them.
    times : int
    equal : bool
        Whether their tables are the same, too.
    labels : dict
        Names that only the pattern has, and what they are called in a plate: ``k`` stands for the number, where the
        members' names differ in a number alone.
    members : tuple of str
        Name of the first variable of each.
    own : frozenset of str
        Names that no other block mentions, of all members.
    """

    pattern: Block
    times: int
    equal: bool
    labels: dict[str, str]
    members: tuple[str, ...]
    own: frozenset[str]


def shapes_of(blocks: tuple[Block, ...]) -> list[Shape]:
    """Blocks grouped by shape, in order of first appearance."""
    mentions = Counter(name for block in blocks for name in _mentioned(block))
    found: dict[object, list[tuple[Block, list[str]]]] = {}
    for block in blocks:
        signature, names = _signature(block, mentions)
        found.setdefault(signature, []).append((block, names))
    stack_of: dict[str, int] = {}
    for number, stack in enumerate(stacks_of(blocks)):
        first = stack.pattern.variables[0].name
        stack_of |= {renaming.get(first, first): number for renaming in stack.names}
    shapes = []
    for members in found.values():
        pattern, names = members[0]
        heads = tuple(block.variables[0].name for block, _ in members)
        labels = {name: _label([own[place] for _, own in members]) for place, name in enumerate(names)}
        own = frozenset(name for _, names_of_one in members for name in names_of_one)
        equal = len({stack_of[head] for head in heads}) == 1
        shapes.append(Shape(pattern, len(members), equal, labels, heads, own))
    return shapes


def dependences(block: Block) -> Iterator[tuple[str, str, Factor]]:
    """Kind, name and table of every factor about a block."""
    yield from (("transition", name, factor) for name, factor in block.transition.items())
    yield from (("likelihood", name, factor) for name, factor in block.likelihood.items())
    yield from (("reward", name, factor) for name, factor in block.rewards)


def _mentioned(block: Block) -> set[str]:
    return {name for _, name, factor in dependences(block) for name in (*factor.names, f"reward {name}")}


def _signature(block: Block, mentions: Counter[str]) -> tuple[object, list[str]]:
    own = {name: place for place, name in enumerate(n for v in block.variables for n in (v.name, v.next.name))}
    parts: list[object] = [tuple(variable.size for variable in block.variables)]
    for kind, name, factor in dependences(block):
        names = [*factor.names, f"reward {name}"] if kind == "reward" else list(factor.names)
        for one in names:
            if mentions[one] == 1 and one not in own:
                own[one] = len(own)
        parts.append((kind, tuple(own.get(one, one) for one in names)))
    return tuple(parts), list(own)


def _label(names: list[str]) -> str:
    """What equal places of the members are called together."""
    if len(names) > 1 and len({re.sub(r"\d+", "", name, count=1) for name in names}) == 1 and len(set(names)) > 1:
        return re.sub(r"\d+", "ₖ", names[0], count=1)
    return names[0]
