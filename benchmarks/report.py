"""What a benchmark hands back: figures by name, aims that are met or not, and a table for people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Aim", "Report", "milliseconds"]


@dataclass(frozen=True)
class Aim:
    """A figure that should stay on one side of a limit.

    Attributes
    ----------
    figure, limit : float
    at_least : bool
        Whether the figure should be above the limit; otherwise below.
    """

    name: str
    figure: float
    limit: float
    at_least: bool = False

    @property
    def met(self) -> bool:
        """Whether it does."""
        return self.figure >= self.limit if self.at_least else self.figure <= self.limit


@dataclass(frozen=True)
class Report:
    """The outcome of one benchmark.

    Attributes
    ----------
    columns, rows
        The table; cells are strings.
    figures : dict
        The same in numbers, for ``--json``.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    figures: dict[str, Any]
    aims: Sequence[Aim] = ()
    notes: Sequence[str] = field(default=())


def milliseconds(seconds: float) -> str:
    """Three digits."""
    return f"{1000 * seconds:,.3g} ms" if seconds < 10 else f"{seconds:,.3g} s"
