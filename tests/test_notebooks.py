"""Notebooks as they are stored (nbmake runs them): outputs are there and clean, and the oracle stands alone."""

from __future__ import annotations

import ast
import re
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

nbformat = pytest.importorskip("nbformat", reason="notebooks need the extra 'notebooks'")
NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))
VERIFY = next(path for path in NOTEBOOKS if path.name.startswith("02_"))


def code_of(path: Path) -> dict[str, str]:
    """Source of the code cells, by their ids."""
    return {cell.id: cell.source for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"}


@pytest.mark.example
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_outputs_are_stored_in_order_and_clean(path: Path) -> None:
    cells = [cell for cell in nbformat.read(path, as_version=4).cells if cell.cell_type == "code"]
    assert [cell.execution_count for cell in cells] == list(range(1, len(cells) + 1))
    outputs = [output for cell in cells for output in cell.outputs]
    assert {output.output_type for output in outputs} <= {"stream", "display_data", "execute_result"}
    assert all(output.name == "stdout" for output in outputs if output.output_type == "stream")
    assert sum("image/png" in output.get("data", {}) for output in outputs) >= 5
    assert not re.search(r'"(/|[A-Z]:\\\\)\w+|/home/|/Users/', path.read_text(encoding="utf-8"))


@pytest.mark.example
@pytest.mark.parametrize("path", NOTEBOOKS[1:], ids=lambda path: path.stem)
def test_the_first_cell_holds_what_may_be_changed(path: Path) -> None:
    """Numbers and names alone, the site and the seed among them; 01 has no site, and names its bees further down."""
    first = nbformat.read(path, as_version=4).cells[0]
    assert first.cell_type == "code"
    body = ast.parse(first.source).body
    assert all(isinstance(line, ast.Assign) for line in body)
    changed = {name.id: name for line in body for name in ast.walk(line) if isinstance(name, ast.Name)}
    assert {"site", "seed"} <= changed.keys()
    assert all(isinstance(name.ctx, ast.Store) for name in changed.values())


@pytest.mark.example
def test_the_oracle_imports_nothing_of_ours_and_knows_a_sum_by_hand() -> None:
    """Targets in view with 1/2 and 1/3, standing still: 5/6; with the printed null and two cells outside, 7/12."""
    source = code_of(VERIFY)["oracle"]
    imported = [node.module for node in ast.walk(ast.parse(source)) if isinstance(node, ast.ImportFrom)]
    assert imported == ["itertools", "math"]
    assert not [node for node in ast.walk(ast.parse(source)) if isinstance(node, ast.Import)]
    alone: dict[str, Any] = {}
    exec(source, alone)
    cells = ["seen", "behind", "far"]
    still = {cell: {cell: Fraction(1)} for cell in cells}
    mass = ({"seen": Fraction(1, 2), "far": Fraction(1, 2)}, {"seen": Fraction(1, 3), "behind": Fraction(2, 3)})
    belief = {((a, b), ("here",)): p * q for a, p in mass[0].items() for b, q in mass[1].items()}

    def value(null: Any) -> Fraction:
        scene = (cells, {cell: cell for cell in cells}, still, cells, [["here"]], {(0, "here"): {"seen"}}, 2, null)
        return alone["oracle"](*scene)["value"](belief, ("here",))

    assert value(lambda outside: 1) == Fraction(5, 6)
    assert value(lambda outside: Fraction(1, outside)) == Fraction(7, 12)
