"""The page on defining a domain, followed to the letter: its blocks run in order, what it shows is what comes."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from tests.fresh_environments import fresh_environment

PROJECT = Path(__file__).parents[1]
PAGE = PROJECT / "docs" / "define-a-domain.md"
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NUMBER = re.compile(r"-?\d[\d,]*\.?\d*(?:e[+-]?\d+)?")


def tools(folder: Path) -> dict[str, str]:
    """A fresh environment's commands; the project and what it needs are borrowed, and nothing is downloaded."""
    python = fresh_environment(folder / "environment")
    scripts = {
        "factored-pomdp": f"#!{python}\nfrom factored_pomdp.commands import main\nmain()\n",
        "pip": f'#!/bin/sh\nexec {sys.executable} -m pip --python {python} "$@"\n',
    }
    for name, text in scripts.items():
        path = python.parent / name
        path.write_text(text, encoding="utf-8")
        path.chmod(0o755)
    offline = {"PIP_NO_INDEX": "1", "PIP_NO_DEPS": "1", "PIP_NO_BUILD_ISOLATION": "0", "PIP_QUIET": "1"}
    return {**os.environ, **offline, "PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}"}


def alike(shown: str, found: str) -> bool:
    """Whether two lines say the same: numbers to one in a hundred, those of times not at all; `…` ends a line."""
    timed = re.search(r"seconds| in \d", shown) is not None
    shown, cut, _ = shown.strip().partition(" …")
    words, others = shown.split(), found.split()
    if len(words) > len(others) or (len(words) < len(others) and not cut):
        return False
    return all(same_word(one, other, timed) for one, other in zip(words, others, strict=False))


def same_word(one: str, other: str, timed: bool) -> bool:
    if one == other:
        return True
    if NUMBER.sub("#", one) != NUMBER.sub("#", other):
        return False
    pairs = zip(NUMBER.findall(one), NUMBER.findall(other), strict=True)
    return timed or all(float(b.replace(",", "")) == pytest.approx(float(a), rel=0.01, abs=0.01) for a, b in pairs)


def unlike(shown: str, found: str) -> str | None:
    """The first line of the page that did not come; a line `…` stands for any number of lines."""
    lines = [line for line in found.splitlines() if line.strip()]
    skipping, place = False, 0
    for line in (line for line in shown.splitlines() if line.strip()):
        if line.strip() == "…":
            skipping = True
            continue
        while skipping and place < len(lines) and not alike(line, lines[place]):
            place += 1
        if place >= len(lines) or not alike(line, lines[place]):
            return line
        skipping, place = False, place + 1
    return None if skipping or place == len(lines) else f"(nothing more, but there was: {lines[place]})"


@pytest.mark.slow
@pytest.mark.end_to_end
@pytest.mark.skipif(os.name == "nt", reason="the page's commands are those of a POSIX shell")
def test_the_page_from_top_to_bottom(tmp_path: Path) -> None:
    surroundings, folder = tools(tmp_path), tmp_path
    program, printed, said = "", "", ""
    blocks = FENCE.findall(PAGE.read_text(encoding="utf-8"))
    assert [kind for kind, _ in blocks].count("console") >= 6
    for kind, text in blocks:
        if kind == "text":
            assert unlike(text, said) is None, f"page:\n{text}\nfound:\n{said}"
        elif kind == "python" and (named := re.match(r"# (\S+\.py)\n", text)):
            (folder / named[1]).write_text(text, encoding="utf-8")
        elif kind == "python":
            program += text
            everything = run(["python", "-c", program], folder, surroundings)
            said, printed = everything.removeprefix(printed), everything
        elif kind == "console":
            for entry in re.split(r"^\$ ", text, flags=re.MULTILINE)[1:]:
                command, _, shown = entry.partition("\n")
                words = shlex.split(command)
                if words[0] == "cd":
                    folder /= words[1]
                    continue
                found = run(words, folder, surroundings)
                wrong = unlike(shown, found)
                assert wrong is None, f"$ {command}\nnot found: {wrong}\n{found}"
    assert [wheel.name for wheel in (folder / "dist").iterdir()] == ["hives-0.1.0-py3-none-any.whl"]
    assert (folder / "hives.png").is_file()


def run(command: list[str], folder: Path, surroundings: dict[str, str]) -> str:
    answer = subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=surroundings)
    assert answer.returncode == 0, f"$ {shlex.join(command)}\n{answer.stdout}{answer.stderr}"
    return answer.stdout


@pytest.mark.example
@pytest.mark.parametrize(
    ("shown", "found", "missing"),
    [
        ("lower  30.54\n", "  lower     30.5438  \n", None),
        ("lower  30.54\n", "  lower     29.5438  \n", "lower  30.54"),
        ("solver, seconds 0.2\n", "solver, seconds 17\n", None),
        ("…\nb 1\n…\n", "a\nb 1\nc\n", None),
        ("…\nb 1\n", "a\nb 1\nc\n", "(nothing more, but there was: c)"),
        ("a …\n", "a b c\n", None),
        ("a\n", "b\n", "a"),
    ],
)
def test_what_counts_as_the_same(shown: str, found: str, missing: str | None) -> None:
    assert unlike(shown, found) == missing
