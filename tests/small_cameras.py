"""Targets that move among a few cells, and cameras whose presets see some of them: the paper's model in small."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor

__all__ = ["UNSEEN", "camera_model", "in_view", "printed_null"]

UNSEEN = "unseen"

Views = Sequence[Mapping[str, frozenset[int]]]
"""For each camera and preset the cells in its field of view."""


def in_view(views: Views, presets: Sequence[str]) -> frozenset[int]:
    """The joint field of view."""
    return frozenset().union(*(camera[preset] for camera, preset in zip(views, presets, strict=True)))


def camera_model(moves: Sequence[np.ndarray], views: Views, initial: Sequence[np.ndarray]) -> fp.FactoredPOMDP:
    """The model of the paper, with P(null | outside) = 1 (`ap:proof4` does not hold otherwise).

    Parameters
    ----------
    moves : for each target (cells, cells)
        ``P(l' | l)``.
    initial : for each target (cells,)
    """
    cells = range(len(initial[0]))
    targets = [fp.Variable(f"target{k}", cells) for k in range(len(moves))]
    cameras = [fp.Variable(f"camera{i}", list(camera)) for i, camera in enumerate(views)]
    turns = [fp.Variable(f"turn{i}", list(camera)) for i, camera in enumerate(views)]
    seen = [fp.Variable(f"seen{k}", [*cells, UNSEEN]) for k in range(len(moves))]
    turned = [f"camera{i}.next" for i in range(len(views))]

    def sight(cell: int, *presets: str) -> Any:
        return cell if cell in in_view(views, presets) else UNSEEN

    return fp.FactoredPOMDP(
        name="small cameras",
        states=[*targets, *cameras],
        actions=turns,
        observations=seen,
        transition={
            **{t.name: DenseFactor([t, t.next], move) for t, move in zip(targets, moves, strict=True)},
            **{c.name: fp.table(turn.name, values=lambda turn: turn) for c, turn in zip(cameras, turns, strict=True)},
        },
        observation={
            z.name: fp.table(f"{t.name}.next", *turned, values=sight) for t, z in zip(targets, seen, strict=True)
        },
        reward={
            t.name: fp.table(f"{t.name}.next", *turned, values=lambda cell, *p: float(cell in in_view(views, p)))
            for t in targets
        },
        initial={
            **{t.name: DenseFactor([t], start) for t, start in zip(targets, initial, strict=True)},
            **{c.name: c.values[0] for c in cameras},
        },
    )


def printed_null(model: fp.FactoredPOMDP) -> dict[str, DenseFactor]:
    """The observation as printed (eq:targetobsprob2): 1/|outside| for the null, at every cell outside."""
    tables = {}
    for name, factor in model.observation.items():
        table = factor.dense()
        target, seen = table.scope[0], table.scope[-1]
        null = table.array[..., seen.index(UNSEEN)]
        outside = null.sum(axis=0, keepdims=True)
        printed = table.array.copy()
        printed[..., seen.index(UNSEEN)] = np.divide(null, outside, out=np.zeros_like(null), where=outside > 0)
        assert target.name.startswith("target")
        tables[name] = DenseFactor(table.scope, printed)
    return tables
