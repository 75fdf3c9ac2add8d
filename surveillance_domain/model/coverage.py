"""Which joint preset sees most of the floor."""

from __future__ import annotations

from itertools import product
from math import prod

import numpy as np

from surveillance_domain.model.views import Views

__all__ = ["best_joint_coverage"]

_MOST_ENUMERATED = 2000


def best_joint_coverage(views: Views) -> tuple[tuple[int, ...], str]:
    """Preset numbers that together have the most free cells in view, and ``"the best"`` or ``"a good"``.

    Up to 2000 joint presets are enumerated, which proves the choice; beyond that cameras are improved one after the
    other until none can be, from the first presets on. Ties keep most cameras at their first presets, where they start.
    """
    masks = [detection > 0 for detection in views.detection]
    if prod(len(camera) for camera in masks) <= _MOST_ENUMERATED:
        joint = product(*(range(len(camera)) for camera in masks))
        return max(joint, key=lambda presets: (_covered(masks, presets), presets.count(0))), "the best"
    chosen = [0] * len(masks)
    improved = True
    while improved:
        improved = False
        for camera in range(len(masks)):
            options = [[*chosen[:camera], preset, *chosen[camera + 1 :]] for preset in range(len(masks[camera]))]
            candidate = max(options, key=lambda presets: _covered(masks, presets))
            if _covered(masks, candidate) > _covered(masks, chosen):
                chosen, improved = candidate, True
    return tuple(chosen), "a good"


def _covered(masks: list[np.ndarray], presets: tuple[int, ...] | list[int]) -> int:
    seen = np.zeros(masks[0].shape[1], dtype=bool)
    for camera, preset in zip(masks, presets, strict=True):
        seen |= camera[preset]
    return int(seen.sum())
