"""Domains from somebody else's distributions, installed into a fresh virtual environment; one of them is broken."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path
from typing import Any

import pytest

from tests.fresh_environments import fresh_environment

pytestmark = pytest.mark.end_to_end

PROJECT = Path(__file__).parents[2]
THIRD_PARTY = PROJECT / "tests" / "third_party"


def packed(source: Path, folder: Path) -> Path:
    """A wheel of a pure Python distribution, made without a build backend, so that nothing is downloaded."""
    described = tomllib.loads((source / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    name, version = described["name"].replace("-", "_"), described["version"]
    inside = f"{name}-{version}.dist-info"
    lines = [line for group, points in described["entry-points"].items() for line in section(group, points)]
    files = {path.relative_to(source).as_posix(): path.read_text(encoding="utf-8") for path in source.rglob("*.py")}
    files |= {
        f"{inside}/METADATA": f"Metadata-Version: 2.1\nName: {described['name']}\nVersion: {version}\n",
        f"{inside}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{inside}/entry_points.txt": "\n".join(lines) + "\n",
    }
    files[f"{inside}/RECORD"] = "".join(f"{file},,\n" for file in [*files, f"{inside}/RECORD"])
    wheel = folder / f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for file, content in files.items():
            archive.writestr(file, content)
    return wheel


def section(group: str, points: dict[str, str]) -> list[str]:
    return [f"[{group}]", *(f"{name} = {value}" for name, value in points.items())]


@pytest.fixture(scope="module")
def python(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A fresh environment's Python, with both plugins installed; the project and what it needs are borrowed."""
    folder = tmp_path_factory.mktemp("third_party")
    fresh = fresh_environment(folder / "environment")
    if shutil.which(sys.executable) is None or not has_pip():
        pytest.skip("this Python has no pip to install the plugins with")
    wheels = [packed(THIRD_PARTY / name, folder) for name in ("weather_domain", "broken_domain")]
    offline = ["--no-deps", "--no-index", "--quiet", "--disable-pip-version-check"]
    pip = [sys.executable, "-m", "pip", "--python", str(fresh), "install", *offline]
    subprocess.run([*pip, *map(str, wheels)], check=True, capture_output=True, text=True)
    return fresh


def has_pip() -> bool:
    return subprocess.run([sys.executable, "-m", "pip", "--version"], capture_output=True, check=False).returncode == 0


def answered(python: Path, *arguments: str) -> tuple[dict[str, Any], str]:
    program = "from factored_pomdp.commands import main; main()"
    command = [str(python), "-c", program, *arguments, "--json"]
    answer = subprocess.run(command, capture_output=True, text=True, check=False, cwd=python.parent)
    assert answer.returncode == 0, answer.stderr
    return json.loads(answer.stdout), answer.stderr


def test_plugins_are_listed_the_broken_one_with_its_error(python: Path) -> None:
    found, warned = answered(python, "domains")
    entries = {entry["name"]: entry for entry in found["domains"]}
    assert entries["weather"] == {
        "name": "weather",
        "summary": "Towns whose weather is forecast, not seen.",
        "distribution": "weather-domain 1.2.3",
        "error": None,
    }
    assert entries["broken"]["error"] == "RuntimeError: this plugin was written for another version"
    assert entries["broken"]["distribution"] == "broken-domain 0.0.1"
    assert {"tiger", "machine-repair", "surveillance"} <= set(entries)
    assert "domain broken (broken-domain 0.0.1) cannot be loaded" in warned


def test_the_new_domain_decomposes_and_is_verified(python: Path) -> None:
    found, _ = answered(python, "decompose", "weather", "-o", "towns=3")
    assert found["blocks"] == [["town1"], ["town2"], ["town3"]]
    found, _ = answered(python, "verify", "weather", "-o", "accuracy=0.7", "--beliefs", "5", "--steps", "5")
    assert found["actions_agree"] == 1.0
    assert max(found["max_value_difference"], found["max_belief_difference"]) <= 1e-9


def test_the_new_domain_is_an_environment_and_the_broken_one_says_why(python: Path) -> None:
    program = (
        "import gymnasium, factored_pomdp.gymnasium\n"
        "print(gymnasium.make('factored_pomdp/weather-v0', towns=3).action_space)\n"
        "gymnasium.make('factored_pomdp/broken-v0')"
    )
    said = subprocess.run([str(python), "-c", program], capture_output=True, text=True, check=False, cwd=python.parent)
    assert said.stdout == "MultiDiscrete([2 2 2])\n"
    assert "domain 'broken' (broken-domain 0.0.1) cannot be loaded: RuntimeError" in said.stderr
