"""Which nodes hang together."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["components"]


def components(size: int, links: Iterable[tuple[int, ...]]) -> list[int]:
    """For each of ``size`` nodes the smallest node of its component (union-find)."""
    parent = list(range(size))

    def root(node: int) -> int:
        while parent[node] != node:
            parent[node] = parent[parent[node]]
            node = parent[node]
        return node

    for link in links:
        roots = {root(node) for node in link}
        for other in roots:
            parent[other] = min(roots)
    return [root(node) for node in range(size)]
