"""What all pictures share: colours that the colour-blind can tell apart, sizes that print, files that are whole.

Figures are made without pyplot, so nothing here depends on a display or leaves anything open.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Mapping
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["COLOURS", "ENDINGS", "INK", "PAPER", "new_figure", "save_figure", "styled"]

Parameters = ParamSpec("Parameters")

# Okabe & Ito, "Color Universal Design" (2008), without black and yellow, which drown in ink and paper.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
PAPER = "#ffffff"
INK = "#1a1a1a"

ENDINGS = (".png", ".svg")
"""Of the files that a picture is written to."""

_SETTINGS: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 9.0,
    "axes.titlesize": 9.0,
    "figure.titlesize": 11.0,
    "axes.edgecolor": INK,
    "text.color": INK,
    "svg.hashsalt": "factored-pomdp",  # otherwise the names inside an SVG differ from run to run
    "svg.fonttype": "path",
}


def styled(draw: Callable[Parameters, Figure]) -> Callable[Parameters, Figure]:
    """Let a drawing function draw with these settings."""

    @wraps(draw)
    def drawn(*arguments: Parameters.args, **options: Parameters.kwargs) -> Figure:
        import matplotlib

        with matplotlib.rc_context(_SETTINGS):
            return draw(*arguments, **options)

    return drawn


def new_figure(width_in: float, height_in: float) -> Figure:
    """An empty figure, in inches, laid out by constraints."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), layout="constrained", facecolor="white")


def save_figure(figure: Figure, path: Path | str) -> tuple[Path, Path]:
    """Write a figure as PNG and, beside it under the same name, as SVG; returns both paths.

    Each file is written under a temporary name and then renamed, so nobody finds half a picture; the same figure gives
    the same SVG, byte for byte. Whatever ending ``path`` has is replaced.

    Raises
    ------
    OSError
        If the folder cannot be made or written to.
    """
    import matplotlib

    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    png, svg = path.with_suffix(".png"), path.with_suffix(".svg")
    with matplotlib.rc_context(_SETTINGS):
        _write(figure, png, {"dpi": 200, "metadata": {"Software": None}})
        _write(figure, svg, {"metadata": {"Date": None, "Creator": None}})
    return png, svg


def _write(figure: Figure, path: Path, options: Mapping[str, Any]) -> None:
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            figure.savefig(file, format=path.suffix[1:], **options)
        umask = os.umask(0)
        os.umask(umask)
        os.chmod(name, 0o666 & ~umask)
        os.replace(name, path)
    except BaseException as problem:
        Path(name).unlink(missing_ok=True)
        if isinstance(problem, OSError) and problem.errno is not None:  # it says what, but not where
            raise OSError(problem.errno, problem.strerror, str(path)) from problem
        raise
