"""The house rules that no other tool holds: portable files, pinned versions, light commands, short files."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
PACKAGES = ("factored_pomdp", "solvers", "surveillance_domain")
SOURCES = sorted(path for package in PACKAGES for path in (PROJECT / package).rglob("*.py"))
LONGEST_FILE = 400
HEAVY = ("numpy", "scipy", "numba", "pgmpy", "cvxpy", "matplotlib", "PIL", "jaxtyping")
MACHINE_PATH = re.compile(r"(?<![\w.~-])/(root|work|Users/\w+|home/\w+)/")
INDEX_ADDRESS = re.compile(r"index[-_]url|find[-_]links|[p]ythonhosted|[p]ypi\.org/simple", re.IGNORECASE)


def tracked_text_files() -> list[tuple[str, str]]:
    """Name and text of every file that git tracks here and that is text."""
    if shutil.which("git") is None or not (PROJECT / ".git").exists():
        pytest.skip("not a git work tree, so which files belong to the project is not known")
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=PROJECT, capture_output=True, text=True, check=True)
    texts = []
    for name in filter(None, listing.stdout.split("\0")):
        path = PROJECT / name
        content = path.read_bytes() if path.is_file() else b""
        if b"\0" not in content:
            texts.append((name, content.decode("utf-8", errors="replace")))
    return texts


def lines_with(pattern: re.Pattern[str]) -> list[str]:
    """Places in tracked text files where a pattern stands, as `file:line: text`."""
    return [
        f"{name}:{number}: {line.strip()[:120]}"
        for name, text in tracked_text_files()
        for number, line in enumerate(text.splitlines(), start=1)
        if pattern.search(line)
    ]


def project_table() -> dict:
    """Table `[project]` of pyproject.toml."""
    return tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def normalised(requirement: str) -> str:
    """Name of a requirement as package registries compare it: lower case, runs of `-_.` one hyphen."""
    name = re.match(r"[A-Za-z0-9._-]+", requirement)
    assert name is not None, requirement
    return re.sub(r"[-_.]+", "-", name.group()).lower()


def pins() -> list[str]:
    """Lines of constraints.txt that are not comments."""
    lines = (PROJECT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


@pytest.mark.example
def test_no_file_names_a_path_of_one_machine() -> None:
    assert lines_with(MACHINE_PATH) == []


@pytest.mark.example
def test_no_file_names_a_package_index() -> None:
    assert lines_with(INDEX_ADDRESS) == []


@pytest.mark.example
def test_the_patterns_find_what_they_look_for() -> None:
    home = "/".join(["", "home", "somebody", "x"])
    assert MACHINE_PATH.search(f"open('{home}')")
    assert not MACHINE_PATH.search(f"a link to docs{home}")
    assert INDEX_ADDRESS.search("--extra-" + "index" + "-url x")


@pytest.mark.example
def test_constraints_are_exact_versions_only() -> None:
    wrong = [line for line in pins() if not re.fullmatch(r"[A-Za-z0-9._-]+==[A-Za-z0-9.!+]+", line)]
    assert wrong == []


@pytest.mark.example
def test_constraints_cover_every_dependency_and_extra() -> None:
    project = project_table()
    wanted = [
        *project["dependencies"],
        *(name for extra in project["optional-dependencies"].values() for name in extra),
    ]
    missing = {normalised(name) for name in wanted} - {normalised(pin) for pin in pins()}
    assert missing == set()


@pytest.mark.example
def test_each_package_says_that_it_is_typed() -> None:
    assert [package for package in PACKAGES if not (PROJECT / package / "py.typed").is_file()] == []


@pytest.mark.example
def test_no_source_file_is_too_long() -> None:
    lengths = {str(path.relative_to(PROJECT)): len(path.read_text(encoding="utf-8").splitlines()) for path in SOURCES}
    assert {name: length for name, length in lengths.items() if length > LONGEST_FILE} == {}


@pytest.mark.example
def test_the_generic_layer_does_not_speak_of_cameras() -> None:
    word = re.compile(r"\b(cameras?|presets?|PTZ)\b", re.IGNORECASE)
    spoken = [
        f"{path.relative_to(PROJECT)}:{number}: {line.strip()}"
        for path in SOURCES
        if path.relative_to(PROJECT).parts[0] != "surveillance_domain"
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1)
        if word.search(line)
    ]
    assert spoken == []


@pytest.mark.end_to_end
@pytest.mark.parametrize("command", sorted(project_table()["scripts"]))
def test_help_loads_nothing_heavy(command: str) -> None:
    module, _, function = project_table()["scripts"][command].partition(":")
    program = (
        f"import sys; sys.argv = [{command!r}, '--help']\n"
        f"from {module} import {function}\n"
        f"try: code = {function}()\n"
        "except SystemExit as stop: code = stop.code\n"
        f"heavy = [name for name in {HEAVY!r} if name in sys.modules]\n"
        "sys.exit(f'exit code {code}' if code else f'loaded {heavy}' if heavy else 0)\n"
    )
    answer = subprocess.run([sys.executable, "-c", program], cwd=PROJECT, capture_output=True, text=True, check=False)
    assert answer.returncode == 0, answer.stderr
    assert command in answer.stdout


@pytest.mark.end_to_end
def test_make_help_lists_every_target() -> None:
    makefile = (PROJECT / "Makefile").read_text(encoding="utf-8")
    phony = re.search(r"^\.PHONY:(.*)$", makefile, re.MULTILINE)
    assert phony is not None
    if shutil.which("make") is None:
        pytest.skip("no make here")
    shown = subprocess.run(["make", "-s"], cwd=PROJECT, capture_output=True, text=True, check=True).stdout
    assert {line.split()[1] for line in shown.splitlines() if line.startswith("  make ")} == set(phony[1].split())
