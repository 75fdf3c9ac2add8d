"""The documentation site: it builds without a warning, fetches nothing, and leaves nothing public out."""

from __future__ import annotations

import html
import importlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from html.parser import HTMLParser
from importlib.metadata import entry_points
from pathlib import Path
from typing import get_args

import pytest
from pydantic import BaseModel

import factored_pomdp as fp
from surveillance_domain.model.views import build_views
from surveillance_domain.site.load import load_site
from surveillance_domain.site.schema import SiteFile

PROJECT = Path(__file__).parents[1]
DOCS = PROJECT / "docs"
PACKAGES = ("factored_pomdp", "solvers", "surveillance_domain")
COMMANDS = {"factored-pomdp": "factored_pomdp.commands", "surveillance": "surveillance_domain.commands"}
FETCHED = {
    ("script", "src"), ("img", "src"), ("img", "srcset"), ("iframe", "src"), ("source", "src"), ("source", "srcset"),
    ("video", "src"), ("audio", "src"), ("object", "data"), ("embed", "src"), ("link", "href"), ("use", "href"),
}  # fmt: skip
ELSEWHERE = re.compile(r"(?:https?:)?//[^\s\"')]+")
IN_STYLE = re.compile(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\s\"')]+)")
NAMED_TEST = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")


class Page(HTMLParser):
    """What is looked for in a page: what it fetches from elsewhere, ids, text."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.outside: list[str] = []
        self.ids: set[str] = set()
        self.parts: list[str] = []
        self._inside: list[str] = []
        self.feed(text)

    @property
    def text(self) -> str:
        return " ".join("".join(self.parts).split())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._inside.append(tag)
        for name, value in attrs:
            if name == "id" and value:
                self.ids.add(value)
            if (tag, name) in FETCHED:
                self.outside += ELSEWHERE.findall(value or "")
            if name == "style":
                self.outside += IN_STYLE.findall(value or "")

    def handle_data(self, data: str) -> None:
        if self._inside and self._inside[-1] == "style":
            self.outside += IN_STYLE.findall(data)
        else:
            self.parts.append(data)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site, built as `make docs` builds it."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    built = subprocess.run(command, cwd=PROJECT, env=environment, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder


def page(site: Path, name: str) -> Page:
    """A page of the built site."""
    return Page((site / name).read_text(encoding="utf-8"))


def sections(model: type[BaseModel]) -> Iterator[type[BaseModel]]:
    """A section of the site file, and those inside it."""
    yield model
    for field in model.model_fields.values():
        waiting = [field.annotation]
        while waiting:
            kind = waiting.pop()
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                yield from sections(kind)
            waiting += get_args(kind)


@pytest.mark.example
def test_what_is_fetched_from_elsewhere_is_found() -> None:
    assert Page('<script src="https://cdn.example/x.js"></script>').outside == ["https://cdn.example/x.js"]
    assert Page('<link rel="stylesheet" href="//fonts.example/f.css">').outside == ["//fonts.example/f.css"]
    assert Page("<style>@import 'https://a.example/b.css'; p { background: url(c.png) }</style>").outside == [
        "https://a.example/b.css"
    ]
    assert Page('<a href="https://example.org">read on</a> <img src="figures/x.png">').outside == []


@pytest.mark.end_to_end
def test_nothing_is_fetched_from_elsewhere(site: Path) -> None:
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 15
    found = {str(path.relative_to(site)): page(site, str(path.relative_to(site))).outside for path in pages}
    for style in site.rglob("*.css"):
        found[str(style.relative_to(site))] = IN_STYLE.findall(style.read_text(encoding="utf-8"))
    assert {name: outside for name, outside in found.items() if outside} == {}


@pytest.mark.end_to_end
def test_formulas_are_set_and_their_font_is_there(site: Path) -> None:
    texts = [path.read_text(encoding="utf-8") for path in site.rglob("*.html")]
    assert not any('class="arithmatex"' in text for text in texts)
    assert (site / "mathematics.html").read_text(encoding="utf-8").count('<math display="block"') >= 10
    assert (site / "assets" / "STIXTwoMath-Regular.ttf").stat().st_size > 100_000


@pytest.mark.end_to_end
@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_name_stands_in_the_reference(site: Path, package: str) -> None:
    public = getattr(importlib.import_module(package), "__all__", ())
    ids = page(site, f"reference/{package}.html").ids
    assert [name for name in public if f"{package}.{name}" not in ids] == []
    assert len([one for one in ids if one.startswith(f"{package}.")]) > 10


@pytest.mark.end_to_end
@pytest.mark.parametrize("program", COMMANDS)
def test_every_command_stands_in_the_reference(
    site: Path, program: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    with pytest.raises(SystemExit):
        importlib.import_module(COMMANDS[program]).main(["--help"])
    told = capsys.readouterr().out.partition("Commands")[2]
    names = re.findall(r"^│ ([a-z][a-z-]*) ", told, re.MULTILINE)
    shown = page(site, f"reference/commands-{program}.html")
    assert len(names) > 5
    assert [name for name in names if f"{program}-{name}" not in shown.ids] == []
    assert "[required]" in shown.text


@pytest.mark.end_to_end
def test_every_key_of_a_site_file_is_described(site: Path) -> None:
    text = page(site, "formats/site.html").text.replace("\u200b", "")
    fields = [(name, field) for model in sections(SiteFile) for name, field in model.model_fields.items()]
    described = [(name, " ".join(html.unescape(str(field.description)).split())) for name, field in fields]
    assert len(described) > 60
    assert [name for name, description in described if f"{name} {description}" not in text] == []


@pytest.mark.end_to_end
def test_every_installed_solver_has_its_paragraph(site: Path) -> None:
    shown = page(site, "solvers.html")
    installed = {point.name for point in entry_points(group="factored_pomdp.solvers")}
    assert len(installed) >= 10
    assert installed - shown.ids == set()


@pytest.mark.end_to_end
def test_every_notebook_is_a_page(site: Path) -> None:
    names = [path.stem for path in PROJECT.glob("notebooks/*.ipynb")]
    assert names
    assert [name for name in names if not (site / "notebooks" / f"{name}.html").exists()] == []
    assert "Is it true that it decomposes?" in page(site, "notebooks/01_define_a_domain.html").text  # its neighbour


@pytest.mark.example
def test_tests_that_pages_name_are_there() -> None:
    pages = [path for path in DOCS.rglob("*.md") if path.name != "paper-to-code.md"]
    named = {found for path in pages for found in NAMED_TEST.findall(path.read_text(encoding="utf-8"))}
    assert len(named) > 40
    missing = [
        f"{path}::{name}"
        for path, name in sorted(named)
        if not (PROJECT / path).is_file() or f"def {name}(" not in (PROJECT / path).read_text(encoding="utf-8")
    ]
    assert missing == []


@pytest.mark.example
def test_the_smallest_site_is_a_site(tmp_path: Path) -> None:
    text = (DOCS / "formats" / "site.md").read_text(encoding="utf-8")
    (tmp_path / "site.toml").write_text(text.split("```toml\n", 1)[1].split("```", 1)[0], encoding="utf-8")
    smallest = load_site(tmp_path / "site.toml")
    assert [camera.name for camera in smallest.cameras] == ["door"]
    assert all((detection > 0).any() for detection in build_views(smallest).detection[0])


@pytest.mark.example
def test_the_printed_tiger_is_the_tiger(tmp_path: Path) -> None:
    text = (DOCS / "formats" / "models.md").read_text(encoding="utf-8")
    (tmp_path / "tiger.pomdp").write_text(text.split("```pomdp\n", 1)[1].split("```", 1)[0], encoding="utf-8")
    printed, installed = (fp.joint(model) for model in (fp.load(tmp_path / "tiger.pomdp"), fp.domain("tiger")))
    assert printed.discount == installed.discount
    assert printed.reward == pytest.approx(installed.reward)
    assert printed.initial == pytest.approx(installed.initial)
    for ours, theirs in ((printed.transition, installed.transition), (printed.observation, installed.observation)):
        for mine, other in zip(ours, theirs, strict=True):
            assert mine.toarray() == pytest.approx(other.toarray())
