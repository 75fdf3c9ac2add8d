"""Numbers and names of values, as both formats write them."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from factored_pomdp.errors import did_you_mean
from factored_pomdp.variables import Variable

__all__ = ["LONGEST_NAME", "MOST_VALUES", "all_numbers", "lookup", "near"]

MOST_VALUES = 500_000
"""Values that a file may name or count for one variable."""

LONGEST_NAME = 1_000
"""Characters that a name may have."""

_MOST_COMPARED = 500


def all_numbers(words: list[str]) -> np.ndarray | None:
    """The words as finite numbers, or ``None`` if one of them is none."""
    try:
        numbers = np.array(list(map(float, words)))
    except ValueError:
        return None
    return numbers if np.isfinite(numbers).all() else None


def lookup(variable: Variable) -> dict[str, int]:
    """Positions by name, or by number where no name looks like one; ``*`` gives -1."""
    positions = {str(position): position for position in range(variable.size)}
    return positions | {str(value): position for position, value in enumerate(variable.values)} | {"*": -1}


def near(word: str, names: Collection[object]) -> str:
    """As `did_you_mean`, but among many names, or for a huge one, only how many there are: comparing takes its time."""
    comparable = len(names) <= _MOST_COMPARED and len(word) <= LONGEST_NAME
    return did_you_mean(word, names) if comparable else f" (there are {len(names):,})"
