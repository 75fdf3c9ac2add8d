"""MODEL on the command line: an installed domain with options, a file, or a function in a Python file."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["ModelName", "Options", "load_model"]

ModelName = Annotated[
    str,
    typer.Argument(
        metavar="MODEL",
        help="An installed domain (see `domains`), a .pomdp or .pomdpx file, or FILE.py, or FILE.py:FUNCTION.",
    ),
]
Options = Annotated[
    list[str] | None,
    typer.Option("-o", "--option", metavar="KEY=VALUE", help="An option of the domain, such as targets=2; repeatable."),
]


def load_model(name: str, options: Sequence[str] | None) -> FactoredPOMDP:
    """The model that MODEL and its options stand for.

    Raises
    ------
    InputError
        With one message, whatever is wrong with the name, the options, the file or the model.
    TooLarge
        Where the domain refuses for its size.
    """
    from factored_pomdp.errors import ModelError, TooLarge

    given = _pairs(options or ())
    path, _, function = name.rpartition(".py:")
    file, function = (path + ".py", function) if path else (name, "")
    try:
        if file.lower().endswith((".pomdp", ".pomdpx")):
            return _read(Path(file), given)
        if file.endswith(".py"):
            return _from_file(Path(file), function, given)
        return _installed(name, given)
    except (InputError, TooLarge):
        raise
    except (ValueError, OSError) as problem:
        bare = (isinstance(problem, ModelError) or file.endswith(".py")) and not str(problem).startswith(file)
        raise InputError(f"{name}: {problem}" if bare else str(problem)) from problem
    except Exception as problem:
        raise InputError(f"{name}: {_described(problem)}") from problem


def _pairs(options: Sequence[str]) -> dict[str, str]:
    pairs: dict[str, str] = {}
    for option in options:
        key, equals, value = option.partition("=")
        if not equals or not key:
            raise InputError(f"option {option!r}: expected KEY=VALUE, such as -o targets=2")
        if key in pairs:
            raise InputError(f"option {key!r} is given twice: {pairs[key]!r} and {value!r}")
        pairs[key] = value
    return pairs


def _installed(name: str, options: Mapping[str, str]) -> FactoredPOMDP:
    from factored_pomdp import registry

    return registry.domain(name, **options)


def _read(path: Path, options: Mapping[str, str]) -> FactoredPOMDP:
    from factored_pomdp.files import load

    if options:
        raise InputError(f"{path}: a file takes no options, but {', '.join(options)} was given")
    try:
        return load(path)
    except FileNotFoundError:
        raise InputError(f"{path}: no such file") from None


def _from_file(path: Path, function: str, options: Mapping[str, str]) -> FactoredPOMDP:
    from factored_pomdp.model import FactoredPOMDP
    from factored_pomdp.options import checked_options

    maker = _maker(path, function)
    model = maker(**checked_options(maker, options, f"{path}:{maker.__name__}"))
    if not isinstance(model, FactoredPOMDP):
        raise InputError(f"{path}:{maker.__name__} returned a {type(model).__name__}; expected a FactoredPOMDP")
    return model


def _maker(path: Path, function: str) -> Callable[..., Any]:
    """The function asked for; else the one named ``model``; else the only public one."""
    from factored_pomdp.errors import did_you_mean

    module = _imported(path)
    public = {
        name: thing
        for name, thing in vars(module).items()
        if callable(thing) and not name.startswith("_") and getattr(thing, "__module__", "") == module.__name__
    }
    if function:
        if function not in public:
            raise InputError(f"{path}: no function {function!r}{did_you_mean(function, public)}")
        return public[function]
    if "model" in public:
        return public["model"]
    if len(public) == 1:
        return next(iter(public.values()))
    names = ", ".join(public) or "none"
    raise InputError(f"{path}: which function makes the model? Say {path}:FUNCTION (there are: {names})")


def _imported(path: Path) -> Any:
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    specification = importlib.util.spec_from_file_location(path.stem, path)
    if specification is None or specification.loader is None:
        raise InputError(f"{path}: not a Python file")
    module = importlib.util.module_from_spec(specification)
    folder = str(path.resolve().parent)
    sys.path.insert(0, folder)
    try:
        specification.loader.exec_module(module)
    except Exception as problem:
        raise InputError(f"{path}: {_described(problem)}") from problem
    finally:
        sys.path.remove(folder)
    return module


def _described(problem: Exception) -> str:
    """Kind and message of an error, and the place where it was raised."""
    if isinstance(problem, SyntaxError):
        return f"line {problem.lineno}: {problem.msg}"
    frame = traceback.extract_tb(problem.__traceback__)[-1]
    return f"{type(problem).__name__}: {problem} ({Path(frame.filename).name}, line {frame.lineno})"
