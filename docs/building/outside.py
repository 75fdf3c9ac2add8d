"""What the site shows of files outside `docs/`: README, CONTRIBUTING and notebooks as pages, others as files."""

from __future__ import annotations

import posixpath
import re
from dataclasses import dataclass
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

__all__ = ["PROJECT", "OutsidePage", "outside_pages", "with_links_into_the_site"]

PROJECT = Path(__file__).parents[2]

_FENCE = re.compile(r"^(```|~~~).*?^\1\s*$", re.MULTILINE | re.DOTALL)
_LINK = re.compile(r"(!?\[[^\]]*\]\(\s*<?)([^)\s>#]+)")
_ELSEWHERE = re.compile(r"[a-z][a-z0-9+.-]*:|/", re.IGNORECASE)


@dataclass(frozen=True)
class OutsidePage:
    """A page that is made from a file outside `docs/`.

    Attributes
    ----------
    origin : Path
        The file.
    address : str
        Where its page stands in the site, as a source file would.
    markdown : str
    pictures : dict
        Contents by their names beside the page.
    """

    origin: Path
    address: str
    markdown: str
    pictures: dict[str, bytes]

    @property
    def title(self) -> str:
        """The first heading, comments in code left out."""
        found = re.search(r"^# (.+)$", _FENCE.sub("", self.markdown), re.MULTILINE)
        return found[1] if found else self.origin.stem

    def files(self, config: MkDocsConfig) -> list[File]:
        """The page and its pictures, as MkDocs takes them."""
        folder = posixpath.dirname(self.address)
        page = File.generated(config, self.address, content=self.markdown)
        beside = [
            File.generated(config, posixpath.join(folder, name), content=content)
            for name, content in self.pictures.items()
        ]
        return [page, *beside]


def outside_pages() -> list[OutsidePage]:
    """The README, CONTRIBUTING, and every notebook with its stored outputs."""
    texts = {"README.md": "get-started.md", "CONTRIBUTING.md": "contributing.md"}
    pages = [
        OutsidePage(PROJECT / name, address, (PROJECT / name).read_text(encoding="utf-8"), {})
        for name, address in texts.items()
    ]
    return pages + [_notebook(path) for path in sorted(PROJECT.glob("notebooks/*.ipynb"))]


def _notebook(path: Path) -> OutsidePage:
    from nbconvert import MarkdownExporter

    resources = {"unique_key": path.stem, "output_files_dir": f"{path.stem}_files"}
    markdown, found = MarkdownExporter().from_filename(str(path), resources=resources)
    return OutsidePage(path, f"notebooks/{path.stem}.md", markdown, dict(found["outputs"]))


def with_links_into_the_site(
    markdown: str, page: File, origin: Path, pages: list[OutsidePage], files: Files, config: MkDocsConfig
) -> str:
    """A page's text with every relative link leading to where the site has its target.

    A file outside `docs/` that is not a page of the site is added to it as it is.

    Parameters
    ----------
    origin : Path
        The file that the text was written in, which its links are relative to.
    """
    addresses = {outside.origin: outside.address for outside in pages}
    folder = posixpath.dirname(page.src_uri)

    def lead(match: re.Match[str]) -> str:
        target = match[2]
        goal = (origin.parent / target).resolve()
        if _ELSEWHERE.match(target) or not goal.is_file():
            return match[0]
        if goal.is_relative_to(Path(config.docs_dir)):
            address = goal.relative_to(config.docs_dir).as_posix()
        elif goal in addresses:
            address = addresses[goal]
        else:
            address = f"files/{goal.relative_to(PROJECT).as_posix()}"
            if files.get_file_from_path(address) is None:
                files.append(File.generated(config, address, content=goal.read_bytes()))
        return match[1] + posixpath.relpath(address, folder or ".")

    def outside_code(text: str) -> str:
        return _LINK.sub(lead, text)

    pieces, end = [], 0
    for fence in _FENCE.finditer(markdown):
        pieces += [outside_code(markdown[end : fence.start()]), fence[0]]
        end = fence.end()
    return "".join([*pieces, outside_code(markdown[end:])])
