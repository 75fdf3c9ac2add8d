"""Words of a ``.pomdp`` file, and the lines they stand on."""

from __future__ import annotations

import re

__all__ = ["Tokens"]

_COMMENT = re.compile(r"#[^\n]*")
_WORD = re.compile(r":|[^\s:]+")
_SIGN = re.compile(r"(?<=\s)([+-])[ \t]+(?=[\d.])")


class Tokens(list[str]):
    """The words and colons of a text without its comments.

    Lines are not counted while the text is taken apart, but when a fault has to be placed (`lines_of`).
    """

    def __init__(self, text: str) -> None:
        self.text = _SIGN.sub(r"\1", _COMMENT.sub("", text))
        super().__init__(_WORD.findall(self.text))

    def lines_of(self, positions: set[int]) -> dict[int, int]:
        """Line numbers, from 1, of the words at some positions (the last line's for what is missing at the end)."""
        lines: dict[int, int] = {}
        line, offset = 1, 0
        for position, match in enumerate(_WORD.finditer(self.text)):
            if position in positions:
                line += self.text.count("\n", offset, match.start())
                offset = match.start()
                lines[position] = line
        end = line + self.text.count("\n", offset, len(self.text.rstrip()))
        return {position: lines.get(position, end) for position in positions}
