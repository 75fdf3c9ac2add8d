"""Whether the numbers of a recording can be what they are taken for: rates, units, paces."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.faults import Fault
from surveillance_domain.trajectories.conventions import Conventions, sidecar_of
from surveillance_domain.trajectories.rows import Rows
from surveillance_domain.trajectories.tracks import Track

__all__ = ["Finer", "finer_than_seconds", "rate_wanted", "speeds", "warnings_of"]

_WALKING_MPS = (0.4, 2.2)
_MOVING_MPS = 0.3
_RATES_AGREE = 0.1
_SELDOM_S = 10.0
_FINER = {"milliseconds": 1e3, "microseconds": 1e6, "nanoseconds": 1e9}


def speeds(rows: Rows, points: Float[np.ndarray, "rows 2"], rate: float) -> Float[np.ndarray, " moves"]:
    """Metres a second between successive rows of one person; rows in order."""
    passed = np.diff(rows.frames) / rate
    moves: Bool[np.ndarray, " pairs"] = (np.diff(rows.tracks) == 0) & (passed > 0)
    return np.hypot(*np.diff(points, axis=0)[moves].T) / passed[moves]


class Finer(NamedTuple):
    """Times that are hardly seconds.

    Attributes
    ----------
    column : str
    found : str
        What they look like.
    remedy : str
        How they are read as that.
    if_not : str
        How they are read as seconds.
    """

    column: str
    found: str
    remedy: str
    if_not: str

    @property
    def fault(self) -> Fault:
        """Where nobody has said that they are seconds."""
        return Fault(self.column, self.found, f"seconds; {self.remedy}; if these are seconds, {self.if_not} says so")

    @property
    def warning(self) -> str:
        """Where it was said."""
        return f"{self.column}: {self.found}; taken as seconds, since --columns or the sidecar says so; {self.remedy}"


def finer_than_seconds(
    rows: Rows, points: Float[np.ndarray, "rows 2"], step_s: float, conventions: Conventions
) -> Finer | None:
    """Times that are hardly seconds, but milliseconds or finer, at which people walk; rows in order.

    People who sit and are seen once a minute look the same; so where a file's column of seconds was named, it is
    believed.

    Parameters
    ----------
    rows : Rows
    points : (rows, 2) float
        In metres.
    step_s : float
        The usual time between two points of one person.
    conventions : Conventions
    """
    if not rows.timed or step_s < _SELDOM_S:
        return None
    pace = speeds(rows, points, 1.0)
    for unit, a_second in _FINER.items():
        walking = pace[pace * a_second > _MOVING_MPS] * a_second
        if walking.size and _WALKING_MPS[0] <= np.median(walking) <= _WALKING_MPS[1]:
            named = {key: header for key, header in (conventions.columns or {}).items() if key != "time_s"}
            column = (conventions.columns or {}).get("time_s", "time_s")
            return Finer(
                column,
                f"a point of one person every {step_s:g}, which would be a walk in {unit}",
                f"{unit} are read with --columns {_told({'frame': column, **named})} --frames-per-s {a_second:.0f}",
                f"--columns {_told({'time_s': column, **named})}",
            )
    return None


def _told(columns: Mapping[str, str]) -> str:
    return ",".join(f"{name}={header}" for name, header in columns.items())


def warnings_of(rows: Rows, rate: float, conventions: Conventions, tracks: tuple[Track, ...]) -> tuple[str, ...]:
    """What looks wrong but is taken as it stands; rows in order."""
    found = []
    if rows.timed and conventions.frames_per_s:
        found.append(
            f"the file tells the time in seconds: {conventions.frames_per_s:g} frames a second, which was given, "
            "is for files that count frames, and plays no part here"
        )
    elif conventions.frames_per_s and rows.frames_per_s and not np.isclose(rate, rows.frames_per_s, rtol=1e-3):
        found.append(
            f"the file itself says {rows.frames_per_s:g} frames a second; {rate:g} was given and is used. If that was "
            "meant for other files, leave --frames-per-s out and write it into the sidecar of each file that needs it: "
            f"FILE.toml beside FILE, with the line frames_per_s = {rate:g}"
        )
    told = _rate_of_velocities(rows, conventions)
    if told is not None and abs(told / rate - 1) > _RATES_AGREE:
        found.append(f"the file's own velocities speak of {told:.3g} frames a second; {rate:g} is used")
    paces = np.concatenate([np.hypot(*np.diff(t.points_m, axis=0).T) / np.diff(t.times_s) for t in tracks])
    moving = paces[paces > _MOVING_MPS]
    if not moving.size:
        found.append(
            f"nobody moves at more than {_MOVING_MPS:g} m/s, and at most at {float(paces.max()):.3g} m/s: "
            f"are {'the times seconds' if rows.timed else 'frame rate'} and unit right?"
        )
    else:
        pace = float(np.median(moving))
        if not _WALKING_MPS[0] <= pace <= _WALKING_MPS[1]:
            found.append(f"people who move go {pace:.3g} m/s, which is not a walk: are frame rate and unit right?")
    return tuple(found)


def _rate_of_velocities(rows: Rows, conventions: Conventions) -> float | None:
    """The rate at which a file's velocities agree with its positions, where both are in metres; rows in order."""
    if rows.velocities is None or conventions.metres_per_unit is not None or conventions.homography is not None:
        return None
    told = np.hypot(*rows.velocities.T)[1:]
    moved = speeds(rows, rows.points, 1.0)
    fits = (np.diff(rows.tracks) == 0) & (np.diff(rows.frames) > 0)
    clear = (moved > 0) & (told[fits] > _MOVING_MPS)
    return float(np.median(told[fits][clear] / moved[clear])) if clear.any() else None


def rate_wanted(rows: Rows, conventions: Conventions, source: str) -> str:
    """In which ways a rate can be given; rows in order."""
    told = _rate_of_velocities(rows, conventions)
    hint = f"; its own velocities speak of about {told:.3g}" if told is not None else ""
    sidecar = sidecar_of(Path(source))
    return f"--frames-per-s F, or the line frames_per_s = F in a file {sidecar} (ETH counts 15 a second, UCY 25{hint})"
