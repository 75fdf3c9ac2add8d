"""TrajNet++ ndjson: a JSON object a line, ``{"track": {"f", "p", "x", "y"}}`` and ``{"scene": {…, "fps"}}``.

``fps`` counts *rows* a second: with frames 10, 20, 30 … and an ``fps`` of 2.5, frames count 25 a second. So the rate of
the frames is ``fps`` times the usual difference of a person's successive frames.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from surveillance_domain.trajectories.rasters import usual_step
from surveillance_domain.trajectories.rows import LineBlock, Rows, RowsBuilder, number_of

__all__ = ["read_trajnet"]

_TRACK = '{"track": {"f": frame, "p": person, "x": x, "y": y}} with finite numbers'
_SCENE = '{"scene": {…, "fps": rows a second}} with a number above 0'


def read_trajnet(blocks: Iterable[LineBlock], source: str) -> Rows:
    """Tracks, and the rate of the frames where scenes tell ``fps``.

    Raises
    ------
    TrajectoryError
        Naming every line that is neither a track nor a scene, and scenes of different rates.
    """
    builder = RowsBuilder(source)
    rates: dict[float, int] = {}
    lines = (numbered for first, block in blocks for numbered in enumerate(block, start=first))
    for number, line in lines:
        if not line.strip():
            continue
        try:
            entry = json.loads(line)
        except json.JSONDecodeError as error:
            builder.fault(number, f"text that is not JSON ({error.msg})", "one JSON object a line")
            continue
        match entry:
            case {"track": dict(track)}:
                _add_track(builder, number, track)
            case {"scene": dict(scene)}:
                _add_rate(builder, number, scene, rates)
            case _:
                builder.fault(number, _cut(line), f"{_TRACK}, or a scene")
    rows = builder.rows_read()
    step = usual_step(rows)
    return replace(rows, frames_per_s=next(iter(rates)) * step) if rates and step else rows


def _add_track(builder: RowsBuilder, line: int, track: Mapping[str, Any]) -> None:
    values = [number_of(str(track.get(key))) for key in ("f", "x", "y")]
    if None in values or isinstance(track.get("p"), (dict, list, type(None))):
        builder.fault(line, _cut(json.dumps(track)), _TRACK)
    else:
        builder.add(line, str(track["p"]), [value for value in values if value is not None])


def _add_rate(builder: RowsBuilder, line: int, scene: Mapping[str, Any], rates: dict[float, int]) -> None:
    if "fps" not in scene:
        return
    rate = number_of(str(scene["fps"]))
    if rate is None or rate <= 0:
        builder.fault(line, f"fps {scene['fps']!r}", _SCENE)
    elif rates and rate not in rates:
        known, first = next(iter(rates.items()))
        builder.fault(line, f"fps {rate:g}, after {known:g} on line {first}", "one rate in a file; cut it in two")
    else:
        rates.setdefault(rate, line)


def _cut(text: str) -> str:
    return text.strip() if len(text.strip()) <= 60 else text.strip()[:57] + "…"
