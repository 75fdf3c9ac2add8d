"""Names as a file can hold them: one word each, no two equal, and the same ones wherever they were words already."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

__all__ = ["BLANKS", "SIGNS", "counted", "words"]

BLANKS = re.compile(r"\s+")
SIGNS = re.compile(r"[\s:#<>&\"',()\[\]{}*]+")
"""What is made an underline: blanks alone, or everything that some reader may stumble over."""


def words(
    names: Iterable[object], reserved: Collection[str] = (), begin: str = "", blank: re.Pattern[str] = SIGNS
) -> list[str]:
    """A word for each name.

    Parameters
    ----------
    reserved : collection of str
        Words that mean something else in the file.
    begin : str
        What is put before a word that begins with a digit or a sign; nothing if empty.
    blank : pattern
        What no word may hold.

    Examples
    --------
    >>> words(["tiger-left", (0, 1), (0, 1.5), "7", "uniform"], reserved=["uniform"], begin="v")
    ['tiger-left', 'v0_1', 'v0_1.5', 'v7', 'uniform_']
    """
    made: dict[str, None] = {}
    for name in names:
        word = str(name)
        if blank.search(word):
            word = blank.sub("_", word).strip("_")
        if not word or (begin and not (word[0].isalpha() or word[0] == "_")):
            word = (begin or "v") + word
        while word in made or word in reserved:
            word += "_"
        made[word] = None
    return list(made)


def counted(names: Iterable[object], letter: str = "") -> bool:
    """Whether the names are ``0``, ``1``, ``2``, … behind a letter."""
    return all(str(name) == f"{letter}{position}" for position, name in enumerate(names))
