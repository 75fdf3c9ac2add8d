"""``factored-pomdp new-domain``: what it writes installs, tests itself and is found; wrong names are refused."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from factored_pomdp.commands import main
from factored_pomdp.scaffold import new_distribution, wrong_with
from tests.fresh_environments import fresh_environment


def run(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict]:
    with pytest.raises(SystemExit) as ended:
        main([*arguments, "--json"])
    return int(ended.value.code or 0), json.loads(capsys.readouterr().out)


@pytest.mark.end_to_end
@pytest.mark.slow  # the page that explains it does the same in a fast test
def test_it_installs_tests_itself_and_is_listed(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, answer = run(capsys, "new-domain", "bee-hives", "--into", str(tmp_path))
    folder = tmp_path / "bee-hives"
    assert (code, answer["written"]) == (0, str(folder))
    written = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert written == {"pyproject.toml", "README.md", "bee_hives.py", "tests/test_bee_hives.py"}
    assert {str(Path(file).relative_to(folder)) for file in answer["files"]} == written
    assert not [path for path in tmp_path.iterdir() if path != folder]

    python = fresh_environment(tmp_path / "environment")
    pip = [sys.executable, "-m", "pip", "--python", str(python), "install", "--quiet", "--disable-pip-version-check"]
    called([*pip, "--no-deps", "--no-index", "--no-build-isolation", "-e", str(folder)], tmp_path)
    assert "2 passed" in called([str(python), "-m", "pytest", "-q", "-p", "no:cacheprovider"], folder)
    program = [str(python), "-c", "from factored_pomdp.commands import main; main()"]
    listed = json.loads(called([*program, "domains", "--json"], tmp_path))["domains"]
    assert {
        "name": "bee-hives",
        "summary": "Things that break unseen, and one visit a step.",
        "distribution": "bee-hives 0.1.0",
        "error": None,
    } in listed
    found = json.loads(called([*program, "decompose", "bee-hives", "-o", "things=3", "--json"], tmp_path))
    assert found["blocks"] == [["thing1"], ["thing2"], ["thing3"]]


def called(command: list[str], folder: Path) -> str:
    answer = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return answer.stdout


@pytest.mark.end_to_end
@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Hives", "expected small letters"),
        ("bee_hives", "expected small letters"),
        ("../hives", "expected small letters"),
        ("tiger", "a domain of that name is installed"),
        ("class", "Python has a module or a word of that name"),
        ("numpy", "Python has a module or a word of that name"),
        ("taken", "taken is there already"),
    ],
)
def test_names_that_cannot_be(capsys: pytest.CaptureFixture[str], tmp_path: Path, name: str, message: str) -> None:
    (tmp_path / "taken").mkdir()
    code, answer = run(capsys, "new-domain", name, "--into", str(tmp_path))
    assert code == 2
    assert message in answer["error"]
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.end_to_end
def test_a_missing_folder_and_a_bad_name_are_said_at_once(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    code, answer = run(capsys, "new-domain", "tiger", "--into", str(tmp_path / "nowhere"))
    assert code == 2
    assert "is installed" in answer["error"]
    assert "there is no such folder" in answer["error"]


@pytest.mark.example
def test_nothing_half_written_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert wrong_with("bee-hives") == []

    def refuse(*arguments: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "rename", refuse)
    with pytest.raises(OSError, match="disk full"):
        new_distribution("bee-hives", tmp_path)
    assert list(tmp_path.iterdir()) == []
