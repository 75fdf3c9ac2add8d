"""Files of points, good and bad."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from surveillance_domain.vision.point_files import PointsError, read_markers, read_points
from surveillance_domain.vision.points import FloorMarker, FloorPoint
from tests.known_points import lego_camera

CAMERA = lego_camera()


def written(folder: Path, text: str, name: str = "points.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.example
def test_csv_and_json_say_the_same(tmp_path: Path) -> None:
    csv = written(tmp_path, "preset,u,v,x_m,y_m,height_m,name\nleft,10,20.5,1,2,,door\n\nright, 3,4, -1,0.5,0.1,\n")
    table = [
        {"preset": "left", "u": 10, "v": 20.5, "x_m": 1, "y_m": 2, "name": "door"},
        {"preset": "right", "u": 3, "v": 4, "x_m": -1, "y_m": 0.5, "height_m": 0.1},
    ]
    door = FloorPoint("door", "left", (10.0, 20.5), (1.0, 2.0))
    assert read_points(csv, CAMERA) == (door, FloorPoint("line 4", "right", (3.0, 4.0), (-1.0, 0.5), 0.1))
    found = read_points(written(tmp_path, json.dumps(table), "points.json"), CAMERA)
    assert found == (door, FloorPoint("point 2", "right", (3.0, 4.0), (-1.0, 0.5), 0.1))


@pytest.mark.example
def test_markers(tmp_path: Path) -> None:
    path = written(tmp_path, "marker,x_m,y_m\n7,1.5,2\n8,0,0\n")
    assert read_markers(path) == {7: FloorMarker(7, (1.5, 2.0)), 8: FloorMarker(8, (0.0, 0.0))}


@pytest.mark.example
def test_all_faults_at_once_with_their_lines(tmp_path: Path) -> None:
    path = written(tmp_path, "preset,u,v,x_m,y_m,heigth_m\nleft,ten,20,1,2,\nleft,nan,20,1,,0\n")
    with pytest.raises(PointsError) as caught:
        read_points(path, CAMERA)
    lines = [str(fault) for fault in caught.value.faults]
    assert lines == [
        'line 2, u: found "ten"; expected a pixel, counted to the right from 0',
        "line 3, u: found nan; expected a pixel, counted to the right from 0",
        "line 3, y_m: found nothing; expected metres",
        "line 3, heigth_m: found an unknown key; expected a key of this table (did you mean height_m?)",
    ]
    assert str(caught.value).startswith(str(path))


@pytest.mark.example
def test_presets_that_are_not_there(tmp_path: Path) -> None:
    path = written(tmp_path, "preset,u,v,x_m,y_m\nleft,1,2,3,4\nup,1,2,3,4\n")
    with pytest.raises(
        PointsError, match='line 3, preset: found "up"; expected one of the presets left, middle, right'
    ):
        read_points(path, CAMERA)


@pytest.mark.example
@pytest.mark.parametrize(
    ("text", "name", "said"),
    [
        ("", "p.csv", "no points"),
        ("preset,u,v,x_m,y_m\n", "p.csv", "no points"),
        ("preset,u,v,x_m,y_m\nleft,1,2\n", "p.csv", "line 2: found 3 columns; expected 5"),
        ("{}", "p.json", "expected a JSON list of objects"),
        ("[1]", "p.json", "expected a JSON list of objects"),
        ("[", "p.json", "not JSON"),
        ("[" * 100_000, "p.json", "not JSON"),
    ],
)
def test_files_of_another_form(tmp_path: Path, text: str, name: str, said: str) -> None:
    with pytest.raises(PointsError, match=said):
        read_points(written(tmp_path, text, name), CAMERA)


@pytest.mark.example
def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    with pytest.raises(PointsError, match="no such file"):
        read_markers(tmp_path / "none.csv")
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(PointsError, match="not UTF-8"):
        read_markers(tmp_path / "bytes.csv")


@pytest.mark.example
def test_a_marker_lies_in_one_place(tmp_path: Path) -> None:
    with pytest.raises(PointsError, match="line 3, marker: found 7 again; expected each marker once"):
        read_markers(written(tmp_path, "marker,x_m,y_m\n7,1,2\n7,3,4\n"))
