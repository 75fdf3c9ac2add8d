"""What the README shows, run as a reader would run it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

README = Path(__file__).parents[1] / "README.md"


@pytest.mark.end_to_end
def test_the_garden_of_the_readme(capsys):
    code = re.search(r"```python\n(.*?)```", README.read_text(encoding="utf-8"), re.DOTALL)
    names: dict[str, object] = {}
    exec(code.group(1), names)
    assert "block 1: roses\nblock 2: beans" in capsys.readouterr().out
    assert names["decision"].action == {"water": "roses"}
    # Watered roses are moist for sure, beans with 0.5 · 0.7: 1.35, whichever of the two is watered.
    assert names["decision"].value == pytest.approx(1.35)
    assert names["belief"].exact
