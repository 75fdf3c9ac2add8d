"""A fresh virtual environment that borrows the project and what it needs, so that nothing is downloaded."""

from __future__ import annotations

import os
import sysconfig
import venv
from pathlib import Path

__all__ = ["fresh_environment"]

PROJECT = Path(__file__).parents[1]


def fresh_environment(folder: Path) -> Path:
    """Make it in a folder; returns its Python."""
    venv.create(folder, with_pip=False, symlinks=os.name != "nt")
    purelib = sysconfig.get_path("purelib", "venv", {"base": str(folder), "platbase": str(folder)})
    borrowed = [sysconfig.get_path("purelib"), sysconfig.get_path("platlib"), str(PROJECT)]
    (Path(purelib) / "borrowed.pth").write_text("\n".join(dict.fromkeys(borrowed)) + "\n", encoding="utf-8")
    return folder / ("Scripts" if os.name == "nt" else "bin") / "python"
