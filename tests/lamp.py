"""Two hidden bits that are seen apart, and a lamp: without its light one of the readings is worth nothing."""

from __future__ import annotations

from typing import Any

import factored_pomdp as fp

__all__ = ["lamp_model"]

BIT = [0, 1]


def lamp_model(**changes: Any) -> fp.FactoredPOMDP:
    """Bits ``x`` and ``y``, the known ``lamp``, the action ``press``; some parts changed."""
    given: dict[str, Any] = {
        "transition": {
            "x": lambda x: {x: 0.75, 1 - x: 0.25},
            "y": lambda y, lamp: {y: 0.75, 1 - y: 0.25} if lamp else y,
            "lamp": lambda press: press,
        },
        "observation": {
            "see.x": lambda x_next, lamp_next: x_next if lamp_next else {0: 0.5, 1: 0.5},
            "see.y": lambda y_next: {y_next: 0.75, 1 - y_next: 0.25},
        },
        "initial": {"x": {0: 0.5, 1: 0.5}, "y": {0: 0.5, 1: 0.5}, "lamp": 0},
    }
    return fp.FactoredPOMDP(
        states=[fp.Variable(name, BIT) for name in given["transition"]],
        actions=[fp.Variable("press", BIT)],
        observations=[fp.Variable(name, BIT) for name in given["observation"]],
        reward={},
        **(given | changes),
    )
