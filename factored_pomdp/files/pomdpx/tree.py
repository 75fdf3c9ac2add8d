"""The elements of a ``.pomdpx`` file with the lines they begin on: bounded, and without entities.

A file that declares entities is refused (a few lines of them can stand for gigabytes), as is one that is nested deeper
or holds more elements than any model needs. Nothing is ever fetched from elsewhere.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.parsers import expat

from factored_pomdp.files.faults import FaultList, FileError, FileFault, shortened
from factored_pomdp.files.values import near

__all__ = ["DEEPEST", "MOST_ELEMENTS", "Element", "Lines", "parsed"]

DEEPEST = 200
MOST_ELEMENTS = 4_000_000

_FUNCTION = ("Var", "Parent", "Parameter")
CHILDREN: dict[str, tuple[str, ...]] = {
    "pomdpx": (
        "Description",
        "Discount",
        "Variable",
        "InitialStateBelief",
        "StateTransitionFunction",
        "ObsFunction",
        "RewardFunction",
    ),
    "Variable": ("StateVar", "ObsVar", "ActionVar", "RewardVar"),
    "StateVar": ("ValueEnum", "NumValues"),
    "ObsVar": ("ValueEnum", "NumValues"),
    "ActionVar": ("ValueEnum", "NumValues"),
    "InitialStateBelief": ("CondProb",),
    "StateTransitionFunction": ("CondProb",),
    "ObsFunction": ("CondProb",),
    "RewardFunction": ("Func",),
    "CondProb": _FUNCTION,
    "Func": _FUNCTION,
    "Parameter": ("Entry", "DAG", "SubDAGTemplate"),
    "Entry": ("Instance", "ProbTable", "ValueTable"),
    "DAG": ("Node", "SubDAG", "Terminal"),
    "SubDAGTemplate": ("Node", "SubDAG", "Terminal"),
    "Node": ("Edge",),
    "Edge": ("Node", "SubDAG", "Terminal"),
}
_CHUNK = 1 << 20


@dataclass(slots=True)
class Element:
    """One element: its tag, attributes, line, children, and its text if the format knows none within it.

    ``foreign`` says that elements stood in it which the format does not know, and which are left out.
    """

    tag: str
    attributes: dict[str, str]
    line: int
    text: str = ""
    children: list[Element] = field(default_factory=list)
    foreign: bool = False

    def all(self, tag: str) -> list[Element]:
        """Children of that tag."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """The first child of that tag."""
        return next((child for child in self.children if child.tag == tag), None)


class Lines:
    """Hands out stamps, and knows the line of each."""

    def __init__(self) -> None:
        self._lines: list[int] = []

    def stamp(self, line: int) -> int:
        """The next stamp, for a statement on this line."""
        self._lines.append(line)
        return len(self._lines) - 1

    def lines_of(self, stamps: set[int]) -> dict[int, int]:
        """The line of each stamp."""
        return {stamp: self._lines[stamp] for stamp in stamps}


class _Refused(Exception):
    def __init__(self, found: str, expected: str) -> None:
        self.found, self.expected = found, expected


def parsed(path: Path, content: bytes, lines: Lines, faults: FaultList) -> Element:
    """The root element; elements that the format does not know are noted and left out.

    Raises
    ------
    FileError
        Where the file is no well-formed XML, or is refused.
    """
    builder = _Builder(lines, faults)
    parser = expat.ParserCreate()
    parser.buffer_text = True
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.characters
    parser.EntityDeclHandler = builder.entity
    builder.parser = parser
    try:
        for begin in range(0, max(len(content), 1), _CHUNK):
            parser.Parse(content[begin : begin + _CHUNK], begin + _CHUNK >= len(content))
    except expat.ExpatError as problem:
        found = f"no well-formed XML ({expat.errors.messages[problem.code]}, column {problem.offset + 1})"
        raise FileError(path, [FileFault("file", found, "XML", problem.lineno)]) from None
    except (ValueError, LookupError) as problem:
        found = f"an encoding that cannot be read ({problem})"
        raise FileError(path, [FileFault("file", found, "UTF-8", parser.CurrentLineNumber)]) from None
    except _Refused as problem:
        raise FileError(path, [FileFault("file", problem.found, problem.expected, parser.CurrentLineNumber)]) from None
    if builder.root is None:
        raise FileError(path, [FileFault("file", "another kind of XML", "<pomdpx> as the outermost element", 1)])
    return builder.root


class _Builder:
    """What the parser calls."""

    def __init__(self, lines: Lines, faults: FaultList) -> None:
        self.parser: Any = None
        self.root: Element | None = None
        self._lines, self._faults = lines, faults
        self._open: list[Element | None] = []
        self._text: list[str] = []
        self._count = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self._count += 1
        if len(self._open) >= DEEPEST:
            raise _Refused(f"elements nested deeper than {DEEPEST}", "fewer")
        if self._count > MOST_ELEMENTS:
            raise _Refused(f"more than {MOST_ELEMENTS:,} elements", "fewer")
        line = self.parser.CurrentLineNumber
        element: Element | None = Element(tag, attributes, line)
        if not self._open:
            if tag != "pomdpx":
                raise _Refused(f"<{shortened(tag)[1:-1]}> as the outermost element", "<pomdpx>")
            self.root = element
        else:
            element = self._placed(element, self._open[-1])
        self._open.append(element)
        self._text.clear()

    def end(self, tag: str) -> None:
        element = self._open.pop()
        if element is not None and tag not in CHILDREN:
            element.text = "".join(self._text)
        self._text.clear()

    def characters(self, text: str) -> None:
        self._text.append(text)

    def entity(self, name: str, *rest: object) -> None:
        raise _Refused(f"a declaration of the entity {shortened(name)}", "a file without entities")

    def _placed(self, element: Element | None, parent: Element | None) -> Element | None:
        if element is None or parent is None:
            return None
        allowed = CHILDREN.get(parent.tag, ())
        if element.tag in allowed:
            parent.children.append(element)
            return element
        parent.foreign = True
        if not self._faults.full:
            others = near(element.tag, allowed) if allowed else " (no element at all)"
            stamp = self._lines.stamp(element.line)
            found = f"<{shortened(element.tag)[1:-1]}>"
            self._faults.note(stamp, f"in <{parent.tag}>", found, f"an element of the format{others}")
        return None
