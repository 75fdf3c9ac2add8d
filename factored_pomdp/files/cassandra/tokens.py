"""Words of a ``.pomdp`` file, and the lines they stand on."""

from __future__ import annotations

import re

from factored_pomdp.files.values import MOST_VALUES

__all__ = ["LISTS", "Tokens"]

_COMMENT = re.compile(r"#[^\n]*")
_WORD = re.compile(r":|[^\s:]+")
_BLANK = re.compile(r"\s")
_SIGN = re.compile(r"(?<=\s)([+-])[ \t]+(?=[\d.])")

_CHUNK = 1 << 20
_ASSUMED = 1_000_000
"""Words that may follow a colon whatever the lists say."""

_SPARE = 10
_DIGITS = 15

LISTS = {"states": "state", "actions": "action", "observations": "observation"}
"""What a list of the preamble is about."""


class Tokens(list[str]):
    """The words and colons of a text without its comments.

    Attributes
    ----------
    cut : bool
        Whether the text goes on: more words follow a colon than any statement can have with the names that have been
        read, and it is not taken apart any further.

    Notes
    -----
    Lines are not counted while the text is taken apart, but when a fault has to be placed (`lines_of`).
    """

    def __init__(self, text: str) -> None:
        self.text = _SIGN.sub(r"\1", _COMMENT.sub("", text))
        self.cut = False
        super().__init__()
        begin, since, most = 0, 0, _ASSUMED
        while begin < len(self.text) and not self.cut:
            end = _BLANK.search(self.text, begin + _CHUNK)
            stop = end.start() if end else len(self.text)
            before = len(self)
            self += _WORD.findall(self.text, begin, stop)
            begin = stop
            since = next((place for place in range(len(self) - 1, before - 1, -1) if self[place] == ":"), since)
            if len(self) - since > most:
                most = max(_ASSUMED, self._most_words())
                self.cut = len(self) - since > most
        if self.cut:
            del self[since + most :]

    def statement_end(self, begin: int) -> int:
        """Where a list of words ends: before the word that a colon follows."""
        try:
            colon = self.index(":", begin)
        except ValueError:
            return len(self)
        two_words = colon - 2 >= begin and self[colon - 2].lower() == "start"
        if two_words and self[colon - 1].lower() in ("include", "exclude"):
            return colon - 2
        return max(colon - 1, begin)

    def table_end(self, begin: int) -> int:
        """Where a statement ends that begins with a table's letter: behind its names and what follows them."""
        name = begin + 2
        while self[name + 1 : name + 2] == [":"]:
            name += 2
        return self.statement_end(min(name + 1, len(self)))

    def _most_words(self) -> int:
        """How many words may follow a colon at the most, with the lists that have been read so far."""
        sizes = dict.fromkeys(LISTS, 0)
        for position in (p for p in range(len(self) - 2) if self[p + 1] == ":" and self[p].lower() in LISTS):
            first = self[position + 2]
            number = int(first) if first.isascii() and first.isdigit() and len(first) < _DIGITS else 0
            listed = self.statement_end(position + 2) - position - 2
            name = self[position].lower()
            size = number if listed == 1 else listed
            sizes[name] = max(sizes[name], size if size <= MOST_VALUES else 0)
        states = sizes["states"]
        return states * max(states, sizes["observations"], 1) + _SPARE

    def lines_of(self, positions: set[int]) -> dict[int, int]:
        """Line numbers, from 1, of the words at some positions (the last line's for what is missing at the end)."""
        lines: dict[int, int] = {}
        line, offset, last = 1, 0, max(positions, default=-1)
        for position, match in enumerate(_WORD.finditer(self.text)):
            if position in positions:
                line += self.text.count("\n", offset, match.start())
                offset = match.start()
                lines[position] = line
            if position >= last:
                break
        end = line + self.text.count("\n", offset, len(self.text.rstrip()))
        return {position: lines.get(position, end) for position in positions}
