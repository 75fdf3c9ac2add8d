"""Every field of the schema wrong in turn. The cases are made from the schema, so no field can be forgotten."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import BaseModel

from surveillance_domain.site.faults import SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.schema import SiteFile

Location = tuple[str | int, ...]

COMPLETE: dict[str, Any] = {
    "schema_version": 1,
    "map": {"rows": ["....", "...."], "cell_m": 1.0, "unknown": "blocked"},
    "targets": {
        "directions": 8,
        "speeds_mps": [0.5, 1.0],
        "sigma_direction_deg": 30.0,
        "sigma_speed_mps": 0.2,
        "walls": "reject",
        "prior": "uniform",
        "known": [{"name": "red", "marker": 7, "color": "#ff2010"}],
        "doors": [{"cells": [[0, 0]], "rate_per_s": 0.05}],
    },
    "control": {"step_s": 1.0, "controller": "pomdp", "deadline_s": 0.1},
    "cameras": [
        {
            "name": "north",
            "mount": {
                "position_m": [0.0, 0.0, 2.5],
                "yaw_deg": 45.0,
                "pitch_deg": 0.0,
                "roll_deg": 0.0,
                "pan_clockwise": True,
                "inverted": False,
            },
            "driver": "vapix",
            "url": "https://192.168.0.90",
            "channel": 1,
            "auth": "digest",
            "username": "operator",
            "password_env": "CAM_NORTH_PASSWORD",
            "ca_file": "north.pem",
            "connect_timeout_s": 2.0,
            "read_timeout_s": 5.0,
            "move_deadline_s": 8.0,
            "settle_s": 0.3,
            "tolerance_deg": 0.2,
            "zoom_hfov": [[1.0, 48.0], [9999.0, 2.7]],
            "image": {"width": 704, "height": 576},
            "required_px_per_m": 125.0,
            "max_depth_m": 12.0,
            "detection_probability": 1.0,
            "cell_noise_m": 0.0,
            "pan_deg_per_s": 100.0,
            "tilt_deg_per_s": 90.0,
            "zoom_per_s": 5000.0,
            "privacy_masks": [{"pan_deg": [-20.0, 10.0], "tilt_deg": [-80.0, -60.0]}],
            "home": "left",
            "presets": [
                {
                    "name": "left",
                    "pan": -30.0,
                    "tilt": -40.0,
                    "zoom": 1.0,
                    "homography": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
                }
            ],
        }
    ],
    "static_cameras": [{"name": "ceiling", "position_m": [2.0, 1.0, 4.0], "noise_m": [0.1, 0.05]}],
    "operation": {"yield_s": 60.0, "forget_s": 120.0, "keep_days": 7.0, "alert_command": "notify-send"},
    "privacy": [{"polygon_m": [[40.0, 40.0], [41.0, 40.0], [41.0, 41.0]]}],
    "markers": {"dictionary": "4X4_50", "side_m": 0.12, "height_m": 0.10},
}
ONLY_ALONE = {("map", "ros")}  # excludes rows; its own tests are in test_site_ros_maps.py
REQUIRED_ELSEWHERE = {("map", "rows")}  # one of rows and ros


def toml(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml(inner) for inner in value) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)


def nested(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((model for part in get_args(annotation) if (model := nested(part)) is not None), None)


def fields(model: type[BaseModel], path: Location = ()) -> Iterator[tuple[Location, Any]]:
    """Path and field of everything in the schema, the first of each list standing for all."""
    for name, field in model.model_fields.items():
        yield (*path, name), field
        inner = nested(field.annotation)
        if inner is not None:
            listed = "tuple" in str(field.annotation)
            yield from fields(inner, (*path, name, 0) if listed else (*path, name))


def value_at(path: Location, document: Any = COMPLETE) -> Any:
    for step in path:
        document = document[step]
    return document


def changed(path: Location, value: Any) -> dict[str, Any]:
    document = copy.deepcopy(COMPLETE)
    value_at(path[:-1], document)[path[-1]] = value
    return document


def first_scalar(path: Location) -> Location:
    while isinstance(value_at(path), list):
        path = (*path, 0)
    return path


FIELDS = [(path, field) for path, field in fields(SiteFile) if path not in ONLY_ALONE]


def wrong_values(path: Location) -> Iterator[tuple[Location, Any]]:
    """Wrong types, and for numbers NaN, infinity and both ends out of range."""
    value = value_at(path)
    if isinstance(value, dict) or (isinstance(value, list) and value and isinstance(value[0], dict)):
        yield path, 5
        yield path, "text"
        return
    if isinstance(value, list):
        yield path, 5
        yield path, "text"
        yield path, []
        path = first_scalar(path)
        value = value_at(path)
    if isinstance(value, bool):
        yield from ((path, wrong) for wrong in (1, "true", [True]))
    elif isinstance(value, int | float):
        yield from ((path, wrong) for wrong in ("1", True, [1.0], {"a": 1}, math.nan, math.inf, -math.inf))
        if "homography" not in path:  # any finite number may stand in a matrix
            yield path, -(10**9)
            if path[-1] != "marker" and "cells" not in path:  # bounded by dictionary and map instead
                yield path, 10**9
    else:
        yield from ((path, wrong) for wrong in (5, False, ["text"], "", "\x07", "x" * 100_000))


def legal_after_all(path: Location, wrong: Any) -> bool:
    """A command and a path may be long; a row is checked by the map."""
    return path == ("operation", "alert_command") and wrong in ("\x07", "x" * 100_000)


CASES = [
    pytest.param(where, wrong, id=f"{'.'.join(map(str, where))}={str(wrong)[:12]!r}")
    for path, _ in FIELDS
    for where, wrong in wrong_values(path)
    if not legal_after_all(where, wrong)
]


def refused(folder: Path, document: dict[str, Any]) -> SiteError:
    (folder / "north.pem").touch()
    file = folder / "site.toml"
    file.write_text("\n".join(f"{key} = {toml(value)}" for key, value in document.items()), encoding="utf-8")
    with pytest.raises(SiteError) as caught:
        load_site(file)
    return caught.value


def key_path(path: Location) -> str:
    return "".join(f"[{step}]" if isinstance(step, int) else f".{step}" for step in path).removeprefix(".")


@pytest.mark.example
def test_the_complete_document_is_complete_and_right(tmp_path: Path) -> None:
    for path, _ in FIELDS:
        value_at(path)
    (tmp_path / "north.pem").touch()
    file = tmp_path / "site.toml"
    file.write_text("\n".join(f"{key} = {toml(value)}" for key, value in COMPLETE.items()), encoding="utf-8")
    site = load_site(file)
    assert site.cameras[0].presets[0].pan == -30.0
    assert site.targets.doors[0].cells == ((0, 0),)


@pytest.mark.example
@pytest.mark.parametrize(("where", "wrong"), CASES)
def test_a_wrong_value_gives_one_message_with_its_place(tmp_path: Path, where: Location, wrong: Any) -> None:
    error = refused(tmp_path, changed(where, wrong))
    assert len(error.faults) == 1, str(error)
    fault = error.faults[0]
    assert key_path(where).startswith(fault.where) or fault.where.startswith(key_path(where)), str(error)
    assert fault.found
    assert fault.expected
    assert "\n" not in str(error)
    assert len(str(error)) < 600


@pytest.mark.example
@pytest.mark.parametrize("path", [path for path, field in FIELDS if field.is_required()], ids=key_path)
def test_a_missing_key_is_named(tmp_path: Path, path: Location) -> None:
    document = copy.deepcopy(COMPLETE)
    del value_at(path[:-1], document)[path[-1]]
    error = refused(tmp_path, document)
    assert [(fault.where, fault.found) for fault in error.faults] == [(key_path(path), "nothing")]


@pytest.mark.example
@pytest.mark.parametrize("path", [path for path, field in FIELDS if not field.is_required()], ids=key_path)
def test_what_is_not_required_may_be_left_out(tmp_path: Path, path: Location) -> None:
    if path in REQUIRED_ELSEWHERE:
        pytest.skip("one of rows and ros is required")
    document = copy.deepcopy(COMPLETE)
    del value_at(path[:-1], document)[path[-1]]
    if path[-1] == "url":
        del document["cameras"][0]["ca_file"]
    (tmp_path / "north.pem").touch()
    file = tmp_path / "site.toml"
    file.write_text("\n".join(f"{key} = {toml(value)}" for key, value in document.items()), encoding="utf-8")
    assert load_site(file).grid.size == 8


TABLES = [(), *(path for path, _ in FIELDS if isinstance(value_at(path), dict))]
LISTS = [(*path, 0) for path, _ in FIELDS if isinstance(value_at(path), list) and isinstance(value_at(path)[0], dict)]


@pytest.mark.example
@pytest.mark.parametrize("table", [*TABLES, *LISTS], ids=lambda path: key_path(path) or "top")
def test_an_unknown_key_is_refused_in_every_table_with_the_nearest_known_one(tmp_path: Path, table: Location) -> None:
    known = next(key for key in value_at(table) if len(key) > 3)
    error = refused(tmp_path, changed((*table, known + "x"), 1))
    assert [fault.where for fault in error.faults] == [key_path((*table, known + "x"))]
    assert f"did you mean {known}" in str(error)
