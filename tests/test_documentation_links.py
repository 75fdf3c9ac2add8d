"""Every relative link in the pages leads to a file, and every anchor to a heading."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[1]
PAGES = sorted([*PROJECT.glob("*.md"), *PROJECT.glob("docs/**/*.md"), *PROJECT.glob("examples/**/*.md")])
FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"!?\[[^\]]*\]\(\s*<?([^)\s>]+)>?[^)]*\)")
ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:", re.IGNORECASE)


def links(text: str) -> list[str]:
    """Targets of the links of a page, those to other hosts and those inside code blocks left out."""
    return [target for target in LINK.findall(FENCE.sub("", text)) if not ELSEWHERE.match(target)]


def anchors(text: str) -> set[str]:
    """Anchors that the headings of a page get when it is rendered."""
    headings = re.findall(r"^#+\s+(.*?)\s*#*$", FENCE.sub("", text), re.MULTILINE)
    return {re.sub(r"\s", "-", re.sub(r"[^\w\s-]", "", heading.lower())) for heading in headings}


def broken_links(page: Path) -> list[str]:
    """Links of a page that lead nowhere, each with the reason."""
    broken = []
    for target in links(page.read_text(encoding="utf-8")):
        path, _, anchor = target.partition("#")
        goal = (page.parent / path).resolve() if path else page
        if not goal.exists():
            broken.append(f"{target}: no such file")
        elif anchor and goal.suffix == ".md" and anchor not in anchors(goal.read_text(encoding="utf-8")):
            broken.append(f"{target}: no such heading")
    return broken


@pytest.mark.example
@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(PROJECT)))
def test_every_relative_link_leads_somewhere(page: Path) -> None:
    assert not broken_links(page), f"{page.name} has links that lead nowhere"


@pytest.mark.example
def test_a_link_that_leads_nowhere_is_found(tmp_path: Path) -> None:
    (tmp_path / "other.md").write_text("# Two words, σ and `code`\n")
    page = tmp_path / "page.md"
    page.write_text(
        "[good](other.md) [good](other.md#two-words-σ-and-code) [out](https://example.org/x) ![gone](gone.png)\n"
        "[bad](other.md#three-words)\n```python\nrows[0](missing.md)\n```\n"
    )
    assert broken_links(page) == ["gone.png: no such file", "other.md#three-words: no such heading"]
