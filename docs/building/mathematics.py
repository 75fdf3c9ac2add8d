"""Formulas as MathML, made when the site is built: nothing runs in the reader's browser and nothing is fetched."""

from __future__ import annotations

import html
import re
from functools import cache
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

__all__ = ["font", "with_mathml"]

_INLINE = re.compile(r'<span class="arithmatex">\\\((.*?)\\\)</span>', re.DOTALL)
_DISPLAYED = re.compile(r'<div class="arithmatex">\s*\\\[(.*?)\\\]\s*</div>', re.DOTALL)

_MACROS = {"widetilde": r"\tilde{#1}"}


def with_mathml(page: str) -> str:
    """A rendered page with each formula that was marked as one turned into MathML.

    Raises
    ------
    math_core.LatexError
        Where a formula cannot be read.
    """
    page = _DISPLAYED.sub(lambda found: f'<div class="formula">{_mathml(found[1], True)}</div>', page)
    return _INLINE.sub(lambda found: _mathml(found[1], False), page)


def font() -> bytes:
    """STIX Two Math (SIL Open Font Licence): not every system has a font for formulas."""
    return Path(str(distribution("ziamath").locate_file("ziamath/fonts/STIXTwoMath-Regular.ttf"))).read_bytes()


def _mathml(formula: str, displayed: bool) -> str:
    converted: str = _converter().convert_with_local_state(html.unescape(formula).strip(), displaystyle=displayed)
    return converted


@cache
def _converter() -> Any:
    from math_core import LatexToMathML

    return LatexToMathML(macros=_MACROS, fancy_error=False)
