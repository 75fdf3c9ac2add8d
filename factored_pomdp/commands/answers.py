"""How every command answers: JSON or a table on standard output, all else on standard error, and an exit code."""

from __future__ import annotations

import errno
import functools
import json
import os
import sys
from collections.abc import Callable, Iterable, Mapping
from contextvars import ContextVar
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.table import Table

__all__ = [
    "COMMAND_LINE",
    "AsJson",
    "InputError",
    "answer",
    "checked_output",
    "guarded",
    "plain",
    "side_console",
    "table",
]

COMMAND_LINE: ContextVar[str] = ContextVar("COMMAND_LINE", default="factored-pomdp")
"""The command as it could be typed again."""

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else on standard output.")]

INTERRUPTED = 130


class InputError(ValueError):
    """What the user gave is wrong; the message says what would be right."""


class Refused(Exception):
    """The answer is no; the message says why."""


def guarded(command: Callable[..., None]) -> Callable[..., None]:
    """The command with wrong input, refusals, unusable files and Ctrl-C turned into one message and an exit code."""

    @functools.wraps(command)
    def run(*arguments: Any, **options: Any) -> None:
        from factored_pomdp.errors import TooLarge

        try:
            command(*arguments, **options)
        except InputError as problem:
            _refuse(str(problem), 2, as_json=bool(options.get("as_json")))
        except Refused as problem:
            _refuse(str(problem), 1, as_json=bool(options.get("as_json")))
        except TooLarge as problem:
            _refuse(f"too large: {problem}", 1, as_json=bool(options.get("as_json")))
        except OSError as problem:
            if problem.errno is None or problem.errno == errno.EPIPE:  # not about a file; whoever read has gone away
                raise
            _refuse(_failed(problem), 2, as_json=bool(options.get("as_json")))
        except KeyboardInterrupt:
            _refuse("interrupted", INTERRUPTED, as_json=bool(options.get("as_json")))

    return run


def answer(content: Mapping[str, Any], shown: Iterable[RenderableType], *, as_json: bool) -> None:
    """Print the answer on standard output, as JSON or as tables and lines."""
    if as_json:
        sys.stdout.write(json.dumps(plain(content), indent=2, ensure_ascii=False) + "\n")
        sys.stdout.flush()
        return
    console = _console(stderr=False)
    for part in shown:
        console.print(part)


def checked_output(option: str, path: Path) -> Path:
    """A file that can be written, as far as can be known before long work begins.

    Raises
    ------
    InputError
        Saying why not.
    """
    if path.is_dir() or not path.name:
        raise InputError(f"{option} {path}: a folder; expected the name of a file")
    if not path.parent.is_dir():
        raise InputError(f"{option} {path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK):
        raise InputError(f"{option} {path}: no permission to write in {path.parent}")
    return path


def side_console() -> Console:
    """Where progress and warnings go."""
    return _console(stderr=True)


def table(*columns: str, title: str | None = None, right: Iterable[str] = ()) -> Table:
    """An empty table; columns in ``right`` hold numbers."""
    from rich.box import SIMPLE_HEAD
    from rich.table import Table

    made = Table(title=title, title_justify="left", box=SIMPLE_HEAD)
    numbers = set(right)
    for column in columns:
        made.add_column(column, overflow="fold", justify="right" if column in numbers else "left")
    return made


def plain(content: Any) -> Any:
    """The same in types that JSON has: names as strings, numbers as Python's own, everything else as it prints."""
    if isinstance(content, Mapping):
        return {str(key): plain(value) for key, value in content.items()}
    if isinstance(content, list | tuple | set | frozenset):
        return [plain(value) for value in content]
    if content is None or isinstance(content, bool | int | float | str):
        return content
    return plain(content.item()) if hasattr(content, "item") else str(content)


def _console(*, stderr: bool) -> Console:
    from rich.console import Console

    console = Console(stderr=stderr, highlight=False, markup=False, emoji=False)
    if not console.is_terminal:
        console.width = 160
    return console


def _failed(problem: OSError) -> str:
    """Such as ``night.png: no space left on device``."""
    where = f"{problem.filename}: " if problem.filename else ""
    return where + (problem.strerror or str(problem)).lower()


def _refuse(message: str, code: int, *, as_json: bool) -> None:
    side_console().print(message, style="bold red" if code != INTERRUPTED else None, soft_wrap=True)
    if as_json:
        from factored_pomdp import __version__

        answer({"error": message, "command": COMMAND_LINE.get(), "version": __version__}, (), as_json=True)
    raise typer.Exit(code)
