"""How far a long job is, and how long it will take, on standard error."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

__all__ = ["Advance", "progress_bar"]

_SECONDS_BETWEEN_LINES = 5.0


class Advance(Protocol):
    """Told how much more is done, and optionally what is being done."""

    def __call__(self, amount: int, doing: str | None = None) -> None: ...


class _Lines:
    """A line every few seconds, where there is no terminal to draw on."""

    def __init__(self, doing: str, total: int) -> None:
        self._doing, self._total, self._done = doing, total, 0
        self._start, self._told = time.monotonic(), -_SECONDS_BETWEEN_LINES

    def __call__(self, amount: int, doing: str | None = None) -> None:
        self._doing, self._done = doing or self._doing, self._done + amount
        now = time.monotonic()
        if now - self._told >= _SECONDS_BETWEEN_LINES and 0 < self._done < self._total:
            left = (now - self._start) * (self._total - self._done) / self._done
            print(f"{self._doing}: {self._done / self._total:.0%}, {left:.0f} s left", file=sys.stderr, flush=True)
            self._told = now


@contextmanager
def progress_bar(doing: str, total: int, wanted: bool | None = None) -> Iterator[Advance]:
    """A bar with the time that is left.

    Parameters
    ----------
    doing : str
    total : int
        Work, in any unit; what is left is foretold from it.
    wanted : bool, optional
        ``None``: only on a terminal.
    """
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        Progress,
        TaskProgressColumn,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    if wanted and not console.is_terminal:
        yield _Lines(doing, total)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Progress(
        *columns, console=console, transient=True, disable=not console.is_terminal or wanted is False
    ) as progress:
        task = progress.add_task(doing, total=total)

        def advance(amount: int, doing: str | None = None) -> None:
            progress.update(task, advance=amount, description=doing)

        yield advance
