"""A new domain's distribution, ready to be installed: one module with a small problem, its entry point, one test."""

from __future__ import annotations

import importlib.util
import keyword
import os
import re
import shutil
import tempfile
from pathlib import Path
from string import Template

__all__ = ["new_distribution", "wrong_with"]

_NAME = re.compile(r"[a-z][a-z0-9]*(-[a-z0-9]+)*")

_MODULE = '''"""$name: things that break unseen, and one visit a step. Put your own problem in its place."""

from __future__ import annotations

import factored_pomdp as fp

__all__ = ["$module"]


def $module(things: int = 2, discount: float = 0.95) -> fp.FactoredPOMDP:
    """Things that break unseen, and one visit a step.

    Parameters
    ----------
    things : int
        At least one. Options of the command line (`-o things=3`) are the parameters of this function.
    discount : float
    """
    if things < 1:
        raise ValueError(f"things={things}: expected at least 1")
    names = [f"thing{number}" for number in range(1, things + 1)]

    def wear(name: str) -> object:
        def after(condition: str, visit: str) -> dict[str, float]:
            if visit == name:
                return {"fine": 1.0}
            return {"fine": 0.9, "broken": 0.1} if condition == "fine" else {"broken": 1.0}

        return fp.table(name, "visit", f"{name}.next", values=after)

    def listen(condition: str) -> dict[str, float]:
        return {"hum": 0.8, "rattle": 0.2} if condition == "fine" else {"hum": 0.3, "rattle": 0.7}

    return fp.FactoredPOMDP(
        name="$name",
        states=[fp.Variable(name, ["fine", "broken"]) for name in names],
        actions=[fp.Variable("visit", ["nobody", *names])],
        observations=[fp.Variable(f"{name}.sound", ["hum", "rattle"]) for name in names],
        transition={name: wear(name) for name in names},
        observation={f"{name}.sound": fp.table(f"{name}.next", f"{name}.sound", values=listen) for name in names},
        reward={
            **{f"{name}.works": fp.table(name, values={"fine": 1.0, "broken": 0.0}) for name in names},
            "trip": lambda visit: 0.0 if visit == "nobody" else -0.5,
        },
        initial={name: {"fine": 1.0} for name in names},
        discount=discount,
    )
'''

_TEST = '''"""What is certain of $name without solving it."""

import factored_pomdp as fp
import pytest

from $module import $module


def test_things_are_independent() -> None:
    certificate = fp.decompose($module(things=3))
    assert certificate.blocks == (("thing1",), ("thing2",), ("thing3",))


def test_a_rattle_is_a_sign() -> None:
    belief = fp.initial_belief($module()).predict("nobody").condition({"thing1.sound": "rattle"})
    # Broken with 0.1 after a step; a rattle weighs that 0.7 to 0.2.
    assert belief.marginal("thing1")[1] == pytest.approx(0.1 * 0.7 / (0.1 * 0.7 + 0.9 * 0.2))
'''

_PYPROJECT = """[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "$name"
version = "0.1.0"
description = "A domain for factored-pomdp"
readme = "README.md"
requires-python = ">=3.11"
dependencies = ["factored-pomdp"]

[project.optional-dependencies]
test = ["pytest"]

[project.entry-points."factored_pomdp.domains"]
$name = "$module:$module"

[tool.setuptools]
py-modules = ["$module"]
"""

_README = """# $name

A domain for factored-pomdp: `$module.py` says what it is about.

```sh
pip install -e '.[test]'    # factored-pomdp then finds the domain by its entry point
python -m pytest
factored-pomdp info $name -o things=3
```
"""


def wrong_with(name: str) -> list[str]:
    """Why a domain cannot have this name; empty if it can."""
    from factored_pomdp import registry

    if not _NAME.fullmatch(name):
        return [
            f"name {name!r}: expected small letters, digits and single hyphens, a letter first, such as 'my-domain'"
        ]
    module, wrong = _module_of(name), []
    if name in {entry.name for entry in registry.domains()}:
        wrong.append(f"name {name!r}: a domain of that name is installed; expected another")
    elif keyword.iskeyword(module) or importlib.util.find_spec(module) is not None:
        wrong.append(f"name {name!r}: Python has a module or a word of that name; expected another")
    return wrong


def new_distribution(name: str, into: Path) -> list[Path]:
    """Write the distribution to ``into / name``, in full or not at all; returns the files.

    Raises
    ------
    FileExistsError
        Where there is something of that name.
    OSError
    """
    folder = into / name
    if folder.exists() or folder.is_symlink():
        raise FileExistsError(f"{folder} is there already")
    module = _module_of(name)
    files = {
        "pyproject.toml": _PYPROJECT,
        "README.md": _README,
        f"{module}.py": _MODULE,
        f"tests/test_{module}.py": _TEST,
    }
    beside = Path(tempfile.mkdtemp(prefix=f".{name}-", dir=into))
    try:
        for file, text in files.items():
            (beside / file).parent.mkdir(exist_ok=True)
            (beside / file).write_text(Template(text).substitute(name=name, module=module), encoding="utf-8")
        umask = os.umask(0)
        os.umask(umask)
        beside.chmod(0o777 & ~umask)
        os.rename(beside, folder)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
    return [folder / file for file in files]


def _module_of(name: str) -> str:
    return name.replace("-", "_")
