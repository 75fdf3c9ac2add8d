"""What can go wrong, each with what was found and what would be right."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from difflib import get_close_matches

__all__ = ["Fault", "ImpossibleObservation", "ModelError", "TooLarge", "did_you_mean"]

_SHOWN = 40


@dataclass(frozen=True)
class Fault:
    """One thing that is wrong with a model.

    Attributes
    ----------
    where : str
        The part of the model and, for a distribution, the parents' assignment.
    found : str
        What stands there.
    expected : str
        What would be right.
    """

    where: str
    found: str
    expected: str

    def __str__(self) -> str:
        return f"{self.where}: found {self.found}; expected {self.expected}"


class ModelError(ValueError):
    """A model that is not well formed; ``faults`` holds everything that is wrong with it."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        count = len(self.faults)
        lines = [f"{count} fault{'s' if count != 1 else ''} in the model"]
        lines += [f"  {fault}" for fault in self.faults[:_SHOWN]]
        if count > _SHOWN:
            lines.append(f"  … and {count - _SHOWN} more (all of them are in .faults)")
        super().__init__("\n".join(lines))


class ImpossibleObservation(ValueError):
    """An observation whose probability under the belief is zero.

    Attributes
    ----------
    block : tuple of str
        Names of the state variables whose belief contradicts the observation.
    """

    def __init__(self, block: Iterable[str], action: object, observation: object) -> None:
        self.block = tuple(block)
        self.action, self.observation = action, observation
        super().__init__(
            f"observation {observation} has probability zero for block [{', '.join(self.block)}] after action "
            f"{action}; the model calls it impossible (pass restart=… to condition() to go on)"
        )


class TooLarge(ValueError):
    """Refused before anything was allocated; the message holds the sizes."""


def did_you_mean(name: object, known: Iterable[object]) -> str:
    """`` (did you mean …?)`` when a known name is close, else the known names."""
    names = [str(other) for other in known]
    close = get_close_matches(str(name), names, n=1)
    if close:
        return f" (did you mean {close[0]!r}?)"
    if len(names) > 12:
        return f" (there are {len(names)}: {', '.join(names[:6])}, …)"
    return f" (there are: {', '.join(names)})" if names else " (there are none)"
