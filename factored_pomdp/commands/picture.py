"""Where a picture goes: checked before the work begins, written as PNG and SVG side by side."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["checked_picture", "written_picture"]


def checked_picture(option: str, path: Path) -> None:
    """Refuse a picture's path that cannot be."""
    from factored_pomdp.pictures.style import ENDINGS

    if path.suffix.lower() not in ENDINGS:
        raise InputError(f"{option} {path}: expected a name that ends with {' or '.join(ENDINGS)}")
    if not path.parent.is_dir():
        raise InputError(f"{option} {path}: there is no folder {path.parent}")


def written_picture(option: str, figure: Figure, path: Path) -> list[str]:
    """Write a figure in both formats; returns the files."""
    from factored_pomdp.pictures.style import save_figure

    try:
        return [str(file) for file in save_figure(figure, path)]
    except OSError as problem:
        raise InputError(f"{option} {path}: {problem.strerror or problem}") from problem
