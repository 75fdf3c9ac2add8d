"""``factored-pomdp graph``, used as a person uses it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from factored_pomdp.commands import main

pytestmark = pytest.mark.end_to_end


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict]:
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--json"])
    return int(ended.value.code or 0), json.loads(capsys.readouterr().out)


def test_it_writes_both_formats_and_the_same_every_time(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, answer = run(capsys, "graph", "rocksample", "--out", str(tmp_path / "rocks.png"))
    assert code == 0
    assert answer["written"] == [str(tmp_path / "rocks.png"), str(tmp_path / "rocks.svg")]
    assert (tmp_path / "rocks.png").read_bytes().startswith(b"\x89PNG")
    first = (tmp_path / "rocks.svg").read_bytes()
    run(capsys, "graph", "rocksample", "--out", str(tmp_path / "rocks.svg"))
    assert (tmp_path / "rocks.svg").read_bytes() == first


@pytest.mark.parametrize(
    ("out", "message"), [("rocks.jpg", "ends with .png or .svg"), ("nowhere/rocks.png", "there is no folder")]
)
def test_paths_that_cannot_be(capsys: pytest.CaptureFixture[str], tmp_path: Path, out: str, message: str) -> None:
    code, answer = run(capsys, "graph", "tiger", "--out", str(tmp_path / out))
    assert code == 2
    assert message in answer["error"]
    assert list(tmp_path.iterdir()) == []


def test_too_large_a_graph_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    options = ("-o", "machines=40", "-o", "coupled=true")
    code, answer = run(capsys, "graph", "machine-repair", *options, "--out", str(tmp_path / "many.png"))
    assert code == 1
    assert "200 nodes" in answer["error"]
