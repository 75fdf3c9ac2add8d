"""A snapshot of two cameras and two targets, made by hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from surveillance_domain.page.snapshot import CameraSnapshot, PictureSnapshot, Snapshot

__all__ = ["camera", "picture", "snapshot"]


def camera(name: str = "north", **changes: Any) -> CameraSnapshot:
    return replace(CameraSnapshot(name, 0, (1.0, 0.0), "ready", 0, "", None), **changes)


def picture(step: int = 1, **changes: Any) -> PictureSnapshot:
    return replace(PictureSnapshot(b"\xff\xd8\xff", (64, 48), step, ()), **changes)


def snapshot(number: int = 1, **changes: Any) -> Snapshot:
    made = Snapshot(
        number=number,
        time_s=1.5 * number,
        cameras=(camera("north"), camera("south")),
        targets=("a", "b"),
        belief=np.full((2, 4), 0.25, dtype=np.float32),
        seen_at={"a": (0, 0)},
        beyond={},
        seen=1,
        present=2,
        truth_m={"a": (0.5, 0.5), "b": (1.5, 0.5)},
        percent_obs=50.0,
        expected=1.2,
        restarts=0,
        decision_ms=2.0,
    )
    return replace(made, **changes)
