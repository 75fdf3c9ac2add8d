"""What MkDocs calls while it builds the site: pages from other files, generated parts, links, formulas.

``<!-- generate: WHAT WORDS -->`` in a page stands for what one of the functions in `GENERATORS` makes of the words.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from commands import command_reference
from mathematics import font, with_mathml
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page
from outside import OutsidePage, outside_pages, with_links_into_the_site
from python_modules import python_reference
from site_keys import site_keys
from solver_abilities import solver_abilities, solver_list

GENERATORS: dict[str, Callable[..., str]] = {
    "commands": command_reference,
    "python": python_reference,
    "site-keys": site_keys,
    "solver-abilities": solver_abilities,
    "solvers": solver_list,
}

_WANTED = re.compile(r"^<!-- generate: (\S+) ?(.*?) ?-->$", re.MULTILINE)
_CODE_OF_FILE = re.compile(r"(?<=<code>)[\w/.-]+\.py::?[\w.]+(?=</code>)")
_outside: list[OutsidePage] = []


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are made from files outside of `docs/` (notebooks to the navigation, too), and a font."""
    _outside[:] = outside_pages()
    notebooks = [{page.title: page.address} for page in _outside if page.origin.suffix == ".ipynb"]
    config.nav = [*(config.nav or []), {"Notebooks": notebooks}]
    for file in (file for page in _outside for file in page.files(config)):
        files.append(file)
    files.append(File.generated(config, "assets/STIXTwoMath-Regular.ttf", content=font()))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Fill in what is generated, and lead links into the site."""
    address = page.file.src_uri
    origin = next((p.origin for p in _outside if p.address == address), Path(config.docs_dir) / address)
    linked = with_links_into_the_site(markdown, page.file, origin, _outside, files, config)
    return _WANTED.sub(lambda found: _generated(found[1], found[2].split(), address), linked)


def on_page_content(html: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Set formulas, mark the paragraphs that name tests, and let long names of code break at their joints."""
    marked = html.replace("<p>Checked by", '<p class="checked">Checked by')
    return with_mathml(_CODE_OF_FILE.sub(lambda found: re.sub(r"([/_:])(?=\w)", r"\1<wbr>", found[0]), marked))


def _generated(what: str, words: list[str], address: str) -> str:
    if what not in GENERATORS:
        raise PluginError(f"{address}: cannot generate {what!r}; expected one of {', '.join(GENERATORS)}")
    return GENERATORS[what](*words)
