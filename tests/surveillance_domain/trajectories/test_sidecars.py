"""What is wrong in a sidecar is told with file and key, whatever stands there."""

from __future__ import annotations

from pathlib import Path

import pytest

from surveillance_domain.trajectories.conventions import Conventions, with_sidecar
from surveillance_domain.trajectories.rows import TrajectoryError

MATRIX = "three rows of three numbers, or the path of a file that holds them"
COLUMNS = 'names of columns, such as { x = "pos_x", id = "person" }'


@pytest.mark.example
@pytest.mark.parametrize(
    ("text", "where", "found", "expected"),
    [
        ("homography = [[1,0],[0,1]]", "homography", "[[1, 0], [0, 1]]", MATRIX),
        ('homography = [[1,0,0],[0,1,0],[0,0,"x"]]', "homography", "[[1, 0, 0], [0, 1, 0], [0, 0, 'x']]", MATRIX),
        ("homography = [[1,0,0],[0,1,0],[0,0,nan]]", "homography", "[[1, 0, 0], [0, 1, 0], [0, 0, nan]]", MATRIX),
        ("homography = []", "homography", "[]", MATRIX),
        ("homography = 3", "homography", "3", MATRIX),
        ('homography = ""', "homography", '""', MATRIX),
        ("homography = { str = 3 }", "homography", "a table", MATRIX),
        ("columns = 3", "columns", "3", COLUMNS),
        ("columns = { x = 3 }", "columns.x", "3", COLUMNS),
        ("columns = { form = 3 }", "columns.form", "3", COLUMNS),  # a name that is a key of the sidecar, too
        ('frames_per_s = "15"', "frames_per_s", '"15"', "frames a second, above 0"),
        ("[frames_per_s]\na = 1", "frames_per_s", "a table", "frames a second, above 0"),
        ("form = 3", "form", "3", '"frame-text", "obsmat", "trajnet" or "csv"'),
    ],
)
def test_a_wrong_value_is_told_once_with_file_and_key(
    tmp_path: Path, text: str, where: str, found: str, expected: str
) -> None:
    (tmp_path / "px.txt.toml").write_text(text)
    with pytest.raises(TrajectoryError) as caught:
        with_sidecar(tmp_path / "px.txt", Conventions())
    assert str(caught.value) == f"{tmp_path / 'px.txt.toml'}: {where}: found {found}; expected {expected}"


@pytest.mark.example
def test_a_homography_with_a_row_too_few_keeps_the_other_faults(tmp_path: Path) -> None:
    (tmp_path / "px.txt.toml").write_text("homography = [[1,0,0],[0,1,0]]\nframe_rate = 3\n")
    with pytest.raises(TrajectoryError) as caught:
        with_sidecar(tmp_path / "px.txt", Conventions())
    assert [fault.where for fault in caught.value.faults] == ["homography", "frame_rate"]
