"""Blocks whose tables are the same up to a renaming of variables, so that one array operation serves them all."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
from factored_pomdp.structure import Block
from factored_pomdp.variables import Value, Variable

__all__ = ["Stack", "stacks_of"]


@dataclass(frozen=True, eq=False)
class Stack:
    """Equal blocks.

    Attributes
    ----------
    pattern : Block
        The block whose factors stand for all.
    names : tuple of dict
        For each block of the stack: names in the pattern to that block's own names.
    own : frozenset of str
        Names in the pattern (of actions, observations, known variables) that differ between the blocks.
    """

    pattern: Block
    names: tuple[dict[str, str], ...]
    own: frozenset[str]


def stacks_of(blocks: Iterable[Block]) -> tuple[Stack, ...]:
    """Group blocks by signature, in order of first appearance."""
    listed = list(blocks)
    mentions = Counter(name for block in listed for name in _mentioned(block))
    digests: dict[tuple[int, ...], tuple[Factor, bytes]] = {}
    kinds = _Kinds()
    found: dict[tuple[object, ...], list[tuple[Block, list[str]]]] = {}
    for block in listed:
        signature, names = _signature(block, mentions, digests, kinds)
        found.setdefault(signature, []).append((block, names))
    stacks = []
    for members in found.values():
        pattern, first = members[0]
        renamings = tuple(dict(zip(first, names, strict=True)) for _, names in members)
        inner = {name for variable in pattern.variables for name in (variable.name, variable.next.name)}
        own = frozenset(name for name in first if name not in inner and len(members) > 1)
        stacks.append(Stack(pattern, renamings, own))
    return tuple(stacks)


def _factors(block: Block) -> list[tuple[str, Factor]]:
    return [
        *(("transition", factor) for factor in block.transition.values()),
        *(("likelihood", factor) for factor in block.likelihood.values()),
        *(("reward", factor) for _, factor in block.rewards),
    ]


def _mentioned(block: Block) -> set[str]:
    return {name for _, factor in _factors(block) for name in factor.names} | {v.name for v in block.variables}


class _Kinds:
    """Numbers the lists of values that there are, each looked at once."""

    def __init__(self) -> None:
        self._kinds: dict[tuple[Value, ...], int] = {}
        self._seen: dict[int, int] = {}

    def of(self, variable: Variable) -> int:
        """Equal for variables with the same values."""
        key = id(variable.values)
        if key not in self._seen:
            self._seen[key] = self._kinds.setdefault(variable.values, len(self._kinds))
        return self._seen[key]


def _signature(
    block: Block, mentions: Counter[str], digests: dict[tuple[int, ...], tuple[Factor, bytes]], kinds: _Kinds
) -> tuple[tuple[object, ...], list[str]]:
    """What two blocks must share to be stacked, and the block's own names in order of first appearance."""
    own: dict[str, int] = {}
    for variable in block.variables:
        own[variable.name] = len(own)
        own[variable.next.name] = len(own)
    parts: list[object] = [tuple(kinds.of(variable) for variable in block.variables)]
    for kind, factor in _factors(block):
        labels: list[object] = []
        for variable in factor.scope:
            if variable.name not in own and mentions[variable.name] == 1:
                own[variable.name] = len(own)
            labels.append((own.get(variable.name, variable.name), kinds.of(variable)))
        parts.append((kind, tuple(labels), _digest(factor, digests)))
    return tuple(parts), list(own)


def _digest(factor: Factor, known: dict[tuple[int, ...], tuple[Factor, bytes]]) -> bytes:
    """A digest of the numbers; factors that share arrays are hashed once."""
    key = factor.storage
    if key not in known:
        found = hashlib.blake2b(type(factor).__name__.encode())
        if isinstance(factor, DenseFactor):
            found.update(factor.array.tobytes())
        elif isinstance(factor, SparseFactor):
            found.update(factor.coordinates.tobytes())
            found.update(factor.numbers.tobytes())
        elif isinstance(factor, DeterministicFactor):
            found.update(factor.indexes.tobytes())
        elif isinstance(factor, NoisyOr):
            found.update(
                repr((factor.off_index, [(c.variable is None, c.activation.shape) for c in factor.causes])).encode()
            )
            for cause in factor.causes:
                table = cause.emission.tocsr()
                for array in (cause.activation, table.indptr, table.indices, table.data):
                    found.update(array.tobytes())
        else:
            found.update(factor.dense().array.tobytes())
        known[key] = factor, found.digest()
    return known[key][1]
