"""Files of points for calibration: CSV with a header, or JSON with a list of objects, of the same keys."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TypeVar

from pydantic import Field, ValidationError

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.explain import Location, faults_of
from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.fields import Count, Height, Metres, Name, Number, Section
from surveillance_domain.vision.points import FloorMarker, FloorPoint

__all__ = ["PointsError", "read_markers", "read_points"]

Row = TypeVar("Row", bound=Section)

_MOST_BYTES = 10_000_000


class PointsError(SiteError):
    """A file of points that cannot be used."""


class _Point(Section):
    preset: Name = Field(description="the name of one of the camera's presets")
    u: Number = Field(description="a pixel, counted to the right from 0")
    v: Number = Field(description="a pixel, counted down from 0")
    x_m: Metres = Field(description="metres")
    y_m: Metres = Field(description="metres")
    height_m: Height = Field(0.0, description="metres above the floor, 0 or more")
    name: Name | None = Field(None, description="a name of 1 to 64 printable characters")


class _Marker(Section):
    marker: Annotated[Count, Field(ge=0)] = Field(description="the number of a marker, 0 or more")
    x_m: Metres = Field(description="metres")
    y_m: Metres = Field(description="metres")
    height_m: Height = Field(0.0, description="metres above the floor, 0 or more")


def read_points(path: Path, camera: Camera) -> tuple[FloorPoint, ...]:
    """Points with ``preset``, ``u``, ``v``, ``x_m``, ``y_m``, and perhaps ``height_m`` and ``name``.

    Pixels belong to pictures of the size that the site gives.

    Raises
    ------
    PointsError
        With every fault of the file at once.
    """
    rows, places = _read(path, _Point)
    names = [preset.name for preset in camera.presets]
    faults = tuple(
        Fault(key_of(place, "preset"), f'"{row.preset}"', f"one of the presets {', '.join(names)}")
        for row, place in zip(rows, places, strict=True)
        if row.preset not in names
    )
    if faults:
        raise PointsError(str(path), faults)
    return tuple(
        FloorPoint(row.name or place, row.preset, (row.u, row.v), (row.x_m, row.y_m), row.height_m)
        for row, place in zip(rows, places, strict=True)
    )


def read_markers(path: Path) -> dict[int, FloorMarker]:
    """Markers with ``marker``, ``x_m``, ``y_m``, and perhaps ``height_m``; by their numbers.

    Raises
    ------
    PointsError
        With every fault of the file at once.
    """
    rows, places = _read(path, _Marker)
    numbers = [row.marker for row in rows]
    twice = [
        Fault(key_of(place, "marker"), f"{row.marker} again", "each marker once")
        for index, (row, place) in enumerate(zip(rows, places, strict=True))
        if row.marker in numbers[:index]
    ]
    if twice:
        raise PointsError(str(path), tuple(twice))
    return {row.marker: FloorMarker(row.marker, (row.x_m, row.y_m), row.height_m) for row in rows}


def key_of(place: str, key: str) -> str:
    """Where a key stands, such as ``line 3, preset``."""
    return f"{place}, {key}"


def _read(path: Path, model: type[Row]) -> tuple[list[Row], list[str]]:
    """The rows of a file, and where each stands: ``line 3`` or ``point 1``."""
    text = _text(path)
    tables, places = _from_json(path, text) if path.suffix.lower() == ".json" else _from_csv(path, text)
    rows: list[Row] = []
    faults: list[Fault] = []
    for table, place in zip(tables, places, strict=True):
        try:
            rows.append(model.model_validate(table))
        except ValidationError as error:
            faults += faults_of(error, model, table, partial(_placed, place))
    if not tables:
        faults.append(Fault("", "no points", "a header and a line for each, or a JSON list of objects"))
    if faults:
        raise PointsError(str(path), tuple(faults))
    return rows, places


def _placed(place: str, location: Location) -> Location:
    return (key_of(place, str(location[0])), *location[1:])


def _text(path: Path) -> str:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise PointsError(str(path), (Fault("", f"{path.stat().st_size} bytes", "at most ten million"),))
        return path.read_text(encoding="utf-8-sig")
    except OSError as problem:
        found = (problem.strerror or str(problem)).lower()
        raise PointsError(str(path), (Fault("", found, "a readable CSV or JSON file"),)) from None
    except UnicodeDecodeError:
        raise PointsError(str(path), (Fault("", "bytes that are not UTF-8", "a CSV or JSON file"),)) from None


def _from_json(path: Path, text: str) -> tuple[list[Any], list[str]]:
    try:
        content = json.loads(text)
    except (json.JSONDecodeError, RecursionError) as problem:
        raise PointsError(str(path), (Fault("", f"text that is not JSON: {problem}", "a list of objects"),)) from None
    if not isinstance(content, list) or not all(isinstance(one, dict) for one in content):
        raise PointsError(str(path), (Fault("", "something else", "a JSON list of objects"),))
    return content, [f"point {number}" for number in range(1, len(content) + 1)]


def _from_csv(path: Path, text: str) -> tuple[list[dict[str, Any]], list[str]]:
    reader = csv.reader(text.splitlines(), skipinitialspace=True)
    header: Sequence[str] = ()
    tables, places, faults = [], [], []
    for words in reader:
        if not any(word.strip() for word in words):
            continue
        if not header:
            header = [word.strip() for word in words]
            continue
        place = f"line {reader.line_num}"
        if len(words) != len(header):
            faults.append(Fault(place, f"{len(words)} columns", f"{len(header)}, as the header has"))
            continue
        filled = {key: word.strip() for key, word in zip(header, words, strict=True) if word.strip()}
        tables.append({key: _value(key, word) for key, word in filled.items()})
        places.append(place)
    if faults:
        raise PointsError(str(path), tuple(faults))
    return tables, places


def _value(key: str, word: str) -> int | float | str:
    if key in ("preset", "name"):
        return word
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return word
