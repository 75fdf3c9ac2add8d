"""Timing on a machine that others use too: rivals take turns, and ratios are taken turn by turn."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import median
from time import perf_counter

__all__ = ["Timing", "in_turns"]

_SHORTEST_S = 10e-3
_MOST_CALLS = 1024


@dataclass(frozen=True)
class Timing:
    """How long one thing took.

    Attributes
    ----------
    seconds : tuple of float
        For each turn the time of one call, averaged over the calls of that turn.
    """

    seconds: tuple[float, ...]

    @property
    def median(self) -> float:
        """Median over turns, in seconds."""
        return median(self.seconds)

    @property
    def best(self) -> float:
        """Shortest turn, in seconds: what an idle machine would take."""
        return min(self.seconds)

    def over(self, other: Timing) -> float:
        """Median over turns of this time divided by the other's in the same turn."""
        return median(mine / theirs for mine, theirs in zip(self.seconds, other.seconds, strict=True))


def in_turns(rivals: Mapping[str, Callable[[], object]], turns: int, budget_s: float) -> dict[str, Timing]:
    """Time several things, one after the other in every turn.

    Parameters
    ----------
    turns : int
        How many at the most; at least one, more only while the budget lasts.
    budget_s : float
        For all rivals together, in seconds; the first calls, which may compile, are not counted.
    """
    calls = {name: _calls(rival) for name, rival in rivals.items()}
    seconds: dict[str, list[float]] = {name: [] for name in rivals}
    until = perf_counter() + budget_s
    for _ in range(turns):
        for name, rival in rivals.items():
            started = perf_counter()
            for _ in range(calls[name]):
                rival()
            seconds[name].append((perf_counter() - started) / calls[name])
        if perf_counter() > until:
            break
    return {name: Timing(tuple(measured)) for name, measured in seconds.items()}


def _calls(rival: Callable[[], object]) -> int:
    """How often to call in one turn, so that what the rival before left in the caches hardly counts."""
    rival()
    calls = 1
    while calls < _MOST_CALLS:
        started = perf_counter()
        for _ in range(calls):
            rival()
        if perf_counter() - started >= _SHORTEST_S:
            break
        calls *= 2
    return calls
