"""What a camera was calibrated from, in a file beside the site file: ``site.calibration.json`` for ``site.toml``."""

from __future__ import annotations

import base64
import binascii
import json
import os
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field, ValidationError

from surveillance_domain.site.camera import Preset
from surveillance_domain.site.explain import faults_of
from surveillance_domain.site.faults import Fault
from surveillance_domain.site.fields import Count, Degrees, Height, Metres, Name, Number, Positive, Section
from surveillance_domain.vision.landmarks import Landmark
from surveillance_domain.vision.opencv import BadImage, decoded, opencv
from surveillance_domain.vision.point_files import PointsError
from surveillance_domain.vision.points import FloorPoint

__all__ = ["Calibrated", "calibration_path", "read_calibrations", "write_calibrations"]


@dataclass(frozen=True, eq=False)
class Calibrated:
    """A preset's calibration.

    Attributes
    ----------
    preset : Preset
        As it was then.
    when : str
        UTC, as ISO 8601 has it.
    residual_m : float
        Of the points that fitted, root mean square.
    landmarks : tuple of Landmark
        Those of them that can be found again.
    """

    preset: Preset
    when: str
    residual_m: float
    landmarks: tuple[Landmark, ...]


class _Point(Section):
    name: str = Field(description="a name, for messages")
    u: Number = Field(description="a pixel, counted to the right from 0")
    v: Number = Field(description="a pixel, counted down from 0")
    x_m: Metres = Field(description="metres")
    y_m: Metres = Field(description="metres")
    height_m: Height = Field(0.0, description="metres above the floor, 0 or more")
    marker: Annotated[Count, Field(ge=0)] | None = Field(None, description="the number of a marker, 0 or more")
    patch: str | None = Field(None, description="a PNG in base64")


class _Preset(Section):
    name: Name = Field(description="the name of a preset")
    pan: Degrees = Field(description="degrees as the camera shows them, -360 to 360")
    tilt: Degrees = Field(description="degrees, positive up, -360 to 360")
    zoom: Positive = Field(description="a zoom position above 0")
    calibrated: str = Field(description="when, as 2026-01-31T12:00:00+00:00")
    residual_m: Metres = Field(description="metres")
    points: tuple[_Point, ...] = Field(description="a list of points")


class _Camera(Section):
    name: Name = Field(description="the name of a camera")
    presets: tuple[_Preset, ...] = Field(description="a list of presets with their points")


class _File(Section):
    schema_version: Literal[1] = Field(description="1")
    cameras: tuple[_Camera, ...] = Field(description="a list of cameras with their presets")


def calibration_path(site_path: Path) -> Path:
    """Where the calibrations of a site file's cameras stand."""
    return site_path.with_suffix(".calibration.json")


def read_calibrations(path: Path) -> dict[str, dict[str, Calibrated]]:
    """Calibrations by camera and preset; none where there is no such file.

    Raises
    ------
    PointsError
        If it is not what `write_calibrations` writes.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        found = _File.model_validate(content)
    except FileNotFoundError:
        return {}
    except ValidationError as error:
        raise PointsError(str(path), faults_of(error, _File, content)) from None
    except (ValueError, RecursionError, OSError) as problem:
        expected = "what surveillance calibrate wrote; calibrate again, or remove it"
        raise PointsError(str(path), (Fault("", f"no calibrations: {problem}", expected),)) from None
    return {
        camera.name: {
            preset.name: _calibrated(path, f"cameras[{number}].presets[{p}]", preset)
            for p, preset in enumerate(camera.presets)
        }
        for number, camera in enumerate(found.cameras)
    }


def write_calibrations(path: Path, camera: str, made: Iterable[Calibrated], anew: bool) -> None:
    """Put calibrations of one camera into the file, which appears whole or stays as it was.

    Parameters
    ----------
    path : Path
    camera : str
    made : iterable of Calibrated
        In place of earlier ones of these presets.
    anew : bool
        Drop those of the camera's other presets.

    Raises
    ------
    PointsError, OSError
        If the file that is there cannot be read, or the new one cannot be written.
    """
    known = read_calibrations(path)
    known[camera] = {**({} if anew else known.get(camera, {})), **{one.preset.name: one for one in made}}
    cameras = [{"name": name, "presets": [_table(one) for one in own.values()]} for name, own in known.items()]
    beside = path.with_name(f".{path.name}.unfinished")
    try:
        beside.write_text(json.dumps({"schema_version": 1, "cameras": cameras}, indent=1) + "\n", encoding="utf-8")
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def _table(one: Calibrated) -> dict[str, Any]:
    at = {"name": one.preset.name, "pan": one.preset.pan, "tilt": one.preset.tilt, "zoom": one.preset.zoom}
    points = [_point_table(landmark) for landmark in one.landmarks]
    return {**at, "calibrated": one.when, "residual_m": one.residual_m, "points": points}


def _point_table(landmark: Landmark) -> dict[str, Any]:
    point, (u, v), (x, y) = landmark.point, landmark.point.pixel, landmark.point.place_m
    table: dict[str, Any] = {"name": point.name, "u": u, "v": v, "x_m": x, "y_m": y, "height_m": point.height_m}
    if point.marker is not None:
        table["marker"] = point.marker
    if landmark.patch is not None:
        _, encoded = opencv().imencode(".png", landmark.patch)
        table["patch"] = base64.b64encode(encoded.tobytes()).decode()
    return table


def _calibrated(path: Path, where: str, one: _Preset) -> Calibrated:
    preset = Preset(name=one.name, pan=one.pan, tilt=one.tilt, zoom=one.zoom)
    points = tuple(_landmark(path, f"{where}.points[{number}]", one.name, p) for number, p in enumerate(one.points))
    return Calibrated(preset, one.calibrated, one.residual_m, points)


def _landmark(path: Path, where: str, preset: str, one: _Point) -> Landmark:
    point = FloorPoint(one.name, preset, (one.u, one.v), (one.x_m, one.y_m), one.height_m, one.marker)
    return Landmark(point, None if one.patch is None else _grey(path, where, one.patch))


def _grey(path: Path, where: str, text: str) -> np.ndarray:
    try:
        pixels: np.ndarray = decoded(base64.b64decode(text, validate=True))[:, :, 0]
    except (binascii.Error, BadImage) as problem:
        raise PointsError(str(path), (Fault(f"{where}.patch", str(problem), "a PNG in base64"),)) from None
    return pixels
