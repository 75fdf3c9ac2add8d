"""The page from paper to code names functions, tests and notebook sections that exist, and the paper's own numbers."""

from __future__ import annotations

import ast
import json
import re
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
PAPER = PROJECT / ".." / "shared" / "paper" / "natarajan2012.tex"
PAGE = (PROJECT / "docs" / "paper-to-code.md").read_text(encoding="utf-8")
NOTEBOOK = PROJECT / "notebooks" / "02_verify_the_decomposition.ipynb"
NAMED = re.compile(r"`([\w/.-]+\.py)(::?)([\w.]+)`")
LABEL = re.compile(r"\\label\{([^}]*)\}")


def names_of(path: Path) -> set[str]:
    """Everything that a module defines at its top, and the methods of its classes."""
    found: set[str] = set()
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        if isinstance(node, ast.ClassDef):
            found |= {f"{node.name}.{inner.name}" for inner in node.body if isinstance(inner, ast.FunctionDef)}
        if isinstance(node, ast.Assign):
            found |= {target.id for target in node.targets if isinstance(target, ast.Name)}
    return found


def rows(heading: str) -> list[list[str]]:
    """Cells of the table under a heading, without its two first lines."""
    text = PAGE.split(f"## {heading}\n", 1)[1].split("\n## ", 1)[0]
    lines = [line for line in text.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


@pytest.mark.example
def test_every_function_and_test_is_there() -> None:
    named = NAMED.findall(PAGE)
    missing = [f"{path}:{name}" for path, _, name in named if not (PROJECT / path).exists()]
    missing += [f"{p}:{name}" for p, _, name in named if (PROJECT / p).exists() and name not in names_of(PROJECT / p)]
    assert not missing
    assert all((mark == "::") == path.startswith("tests/") for path, mark, _ in named)
    assert len(named) > 60


@pytest.mark.example
def test_every_section_of_the_notebook_is_there() -> None:
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    text = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "markdown")
    sections = set(re.findall(r"^#+ (\d(?:\.\d)?)\.? ", text, re.MULTILINE))
    columns = (("Equations", 5), ("Derivations of the appendix", 3), ("What has no equation", 4))
    cited = {part for heading, column in columns for row in rows(heading) for part in row[column].split(", ") if part}
    assert cited <= sections
    assert {"1", "2", "3.1", "3.2", "3.3", "3.4", "3.5", "4", "6"} <= cited


@pytest.mark.example
def test_labels_and_numbers_are_the_papers_own() -> None:
    if not PAPER.exists():
        pytest.skip("the paper's source is not beside this repository")
    body = PAPER.read_text(encoding="utf-8").split(r"\appendix")[0]
    printed, number = {}, 0
    for star, inside in re.findall(r"\\begin\{equation(\*?)\}(.*?)\\end\{equation\*?\}", body, re.DOTALL):
        number += not star
        printed |= {label: "—" if star else f"({number})" for label in LABEL.findall(inside)}
    assert {row[0]: row[1] for row in rows("Equations")} == printed
