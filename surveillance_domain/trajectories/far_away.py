"""People who are so far from all others, in space or in time, that something is wrong: told by name and line."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from surveillance_domain.trajectories.prior import MOST_CELLS, cells_over
from surveillance_domain.trajectories.tracks import Track

__all__ = ["long_pause", "refuse_far_people"]

_FEW = 0.1
_SHOWN = 5
_PAUSE_S = 86_400.0
_TOO_FEW = 2
"""Of two people nobody can say which is far away."""


def refuse_far_people(tracks: Sequence[Track], cell_m: float) -> None:
    """Refuse tracks that spread over too many cells.

    Those farthest from the median of where people are go first, until the others lie in few enough cells. Where that
    takes more than a tenth of the people, people really spread, and larger cells are the first thing to be advised.

    Raises
    ------
    ValueError
        Naming those farthest away, and where each is.
    """
    own: dict[str, list[Track]] = {}
    for track in tracks:
        own.setdefault(track.name, []).append(track)
    points = {name: np.concatenate([track.points_m for track in parts]) for name, parts in own.items()}
    corners = {name: np.stack([one.min(axis=0), one.max(axis=0)]) for name, one in points.items()}
    if _few_enough(corners.values(), cell_m):
        return
    centre = np.median([np.median(one, axis=0) for one in points.values()], axis=0)
    farthest = {name: max(_farthest(track, centre) for track in parts) for name, parts in own.items()}
    falling = sorted(own, key=lambda name: farthest[name], reverse=True)

    def shown(names: Sequence[str]) -> str:
        return "; ".join(f"id {name}, {farthest[name]}" for name in names[:_SHOWN])

    most = max(1, int(_FEW * len(own))) if len(own) > _TOO_FEW else 0
    for count in range(1, most + 1):
        near = [corners[name] for name in falling[count:]]
        if _few_enough(near, cell_m):
            width, height = np.ptp(np.concatenate(near), axis=0).tolist()
            more = f"; and {count - _SHOWN:,} more" if count > _SHOWN else ""
            raise ValueError(
                f"{count:,} of {len(own):,} people {'is' if count == 1 else 'are'} far from all others, who keep "
                f"within {width:,.6g} x {height:,.6g} m: {shown(falling[:count])}{more}; expected people of one place: "
                "take the rows of those far away out, or mend their positions if these are in another unit"
            )
    columns, rows = cells_over(np.concatenate(list(corners.values())), cell_m)
    raise ValueError(
        f"people spread over {columns:,} x {rows:,} cells of {cell_m:g} m; give a larger --cell-m, or take out who is "
        f"far from the others; the farthest: {shown(falling)}"
    )


def long_pause(tracks: Sequence[Track]) -> str | None:
    """The longest time without anybody, and who comes after it, where it is over a day and most of the recording."""
    ordered = sorted(tracks, key=lambda track: float(track.times_s[0]))
    begins = np.array([track.times_s[0] for track in ordered])
    ends = np.maximum.accumulate([track.times_s[-1] for track in ordered])
    pauses = begins[1:] - ends[:-1]
    if not pauses.size or pauses.max() <= max(_PAUSE_S, (ends[-1] - begins[0]) / 2):
        return None
    at = int(pauses.argmax()) + 1
    after = ordered[at]
    before = len({track.name for track in ordered[:at]})
    line = "" if after.lines is None else f", on line {int(after.lines[0])}"
    people = len({track.name for track in tracks})
    return (
        f"nobody is there for {pauses[at - 1]:,.6g} s, after {before:,} of {people:,} people; "
        f"then comes id {after.name} at {begins[at]:.12g} s{line}"
    )


def _few_enough(corners: Iterable[Float[np.ndarray, "2 2"]], cell_m: float) -> bool:
    columns, rows = cells_over(np.concatenate(list(corners)), cell_m)
    return columns * rows <= MOST_CELLS


class _Far(NamedTuple):
    """A point of a track, and how far away it is; line 0 where that is not known."""

    away_m: float
    x: float
    y: float
    time_s: float
    line: int

    def __str__(self) -> str:
        where = f"on line {self.line}" if self.line else f"after {self.time_s:g} s"
        return f"at ({self.x:.6g}, {self.y:.6g}) m {where}"


def _farthest(track: Track, centre: Float[np.ndarray, "2"]) -> _Far:
    away = np.hypot(*(track.points_m - centre).T)
    at = int(away.argmax())
    x, y = track.points_m[at].tolist()
    line = 0 if track.lines is None else int(track.lines[at])
    return _Far(float(away[at]), x, y, float(track.times_s[at]), line)
