"""The names, the discount and the start of a ``.pomdp`` file."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from factored_pomdp.files.cassandra.tokens import LISTS, Tokens
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.values import LONGEST_NAME, MOST_VALUES, all_numbers, lookup, near
from factored_pomdp.validation import TOLERANCE
from factored_pomdp.variables import Variable

__all__ = ["KEYWORDS", "Preamble"]


@dataclass
class Preamble:
    """What stands before the tables; a part is ``None`` until it has been read.

    Attributes
    ----------
    variables : dict
        ``states``, ``actions`` and ``observations``. Those that are counted and not named have the values ``"0"``,
        ``"1"``, ….
    start : (N,) float
        Uniform where the file does not say, or says none that is right.
    costs : bool
        Whether rewards are costs.
    """

    faults: FaultList
    discount: float | None = None
    costs: bool = False
    variables: dict[str, Variable] = field(default_factory=dict)
    start: np.ndarray | None = None
    _said: set[str] = field(default_factory=set)
    _meant: set[str] = field(default_factory=set)

    def read(self, keyword: str, tokens: Tokens, begin: int, end: int) -> None:
        """Read what follows a keyword and its colon: the words from ``begin`` up to ``end``."""
        if keyword in self._said:
            self.faults.note(begin - 1, keyword, "a second one", "one")
            return
        self._said.add(keyword)
        if begin == end:
            self.faults.note(begin - 1, keyword, "nothing", EXPECTED[keyword])
            return
        READERS[keyword](self, keyword, tokens, begin, end)

    def lost(self, keyword: str) -> bool:
        """Whether the file says a list of names, but not so that it could be read."""
        return keyword in self._said | self._meant and keyword not in self.variables

    def was_meant(self, keyword: str) -> None:
        """Take note that a keyword stands in the file, it seems, though it cannot be read."""
        self._meant.add(keyword)

    def check_complete(self) -> None:
        """Note what is missing; a file without observations is a Markov decision process."""
        for keyword in ("discount", "states", "actions"):
            if keyword not in self._said | self._meant:
                self.faults.note(None, keyword, "nothing", EXPECTED[keyword])

    def belief(self) -> np.ndarray:
        """The start as probabilities: uniform where the file does not say."""
        if self.start is not None:
            return self.start
        size = self.variables["states"].size
        return np.full(size, 1 / size)

    def _discount(self, keyword: str, tokens: Tokens, begin: int, end: int) -> None:
        numbers = all_numbers(tokens[begin:end])
        if numbers is None or len(numbers) != 1 or not 0 <= numbers[0] <= 1:
            self.faults.note(begin, keyword, shortened(" ".join(tokens[begin:end][:5])), EXPECTED[keyword])
        else:
            self.discount = float(numbers[0])

    def _values(self, keyword: str, tokens: Tokens, begin: int, end: int) -> None:
        if end != begin + 1 or tokens[begin].lower() not in ("reward", "cost"):
            self.faults.note(begin, keyword, shortened(" ".join(tokens[begin:end][:5])), EXPECTED[keyword])
        self.costs = tokens[begin].lower() == "cost"

    def _names(self, keyword: str, tokens: Tokens, begin: int, end: int) -> None:
        names = tokens[begin:end]
        if len(names) == 1 and names[0].isascii() and names[0].isdigit():
            number = int(names[0]) if len(names[0]) < 15 else math.inf
            if not 1 <= number <= MOST_VALUES:
                self.faults.note(begin, keyword, shortened(names[0]), f"1 to {MOST_VALUES:,}")
                return
            names = [str(position) for position in range(int(number))]
        if len(names) > MOST_VALUES:
            self.faults.note(begin, keyword, f"{len(names):,} names", f"at most {MOST_VALUES:,}")
            return
        seen: set[str] = set()
        before = len(self.faults)
        for position, name in enumerate(names):
            if name in seen:
                self.faults.note(begin + position, keyword, f"{shortened(name)} again", "every name once")
            if len(name) > LONGEST_NAME:
                found = f"{shortened(name)}, a name of {len(name):,} characters"
                self.faults.note(begin + position, keyword, found, f"at most {LONGEST_NAME:,}")
            if self.faults.full:
                return
            seen.add(name)
        if len(self.faults) > before:
            return
        self.variables[keyword] = Variable(LISTS[keyword], dict.fromkeys(names))

    def _start(self, keyword: str, tokens: Tokens, begin: int, end: int) -> None:
        states, words = self.variables.get("states"), tokens[begin:end]
        if states is None:
            if not self.lost("states"):
                self.faults.note(begin, keyword, "a start", "'states:' before it")
            return
        if keyword != "start":
            self._some(keyword, states, words, begin)
        elif words == ["uniform"]:
            self.start = None
        elif len(words) == 1 and (states.size > 1 or words[0] in lookup(states)):
            self._some(keyword, states, words, begin)
        else:
            numbers = all_numbers(words)
            if numbers is None or len(numbers) != states.size:
                what = f"{len(words):,} words" if numbers is None else f"{len(numbers):,} numbers"
                self.faults.note(begin, keyword, what, f"{states.size:,} probabilities, one for each state")
                return
            if self._is_distribution(numbers, begin):
                self.start = numbers

    def _is_distribution(self, numbers: np.ndarray, begin: int) -> bool:
        before = len(self.faults)
        if not ((numbers >= 0) & (numbers <= 1 + TOLERANCE)).all():
            self.faults.note(begin, "start", "a number outside of [0, 1]", "probabilities")
        elif not abs(numbers.sum() - 1) <= TOLERANCE:
            self.faults.note(begin, "start", f"probabilities that sum to {numbers.sum():.9g}", "sum 1")
        return len(self.faults) == before

    def _some(self, keyword: str, states: Variable, words: list[str], begin: int) -> None:
        find = lookup(states)
        chosen = np.zeros(states.size, dtype=bool)
        for position, word in enumerate(words):
            index = find.get(word, -1)
            if index < 0:
                self.faults.note(begin + position, keyword, shortened(word), f"a state{near(word, states.values)}")
                return
            chosen[index] = True
        if keyword == "start exclude":
            chosen = ~chosen
        if not chosen.any():
            self.faults.note(begin, keyword, "every state", "at least one state left over")
            return
        self.start = chosen / chosen.sum()


EXPECTED = {
    "discount": "a number in [0, 1]",
    "values": "'reward' or 'cost'",
    "states": "a number of states, or their names",
    "actions": "a number of actions, or their names",
    "observations": "a number of observations, or their names",
    "start": "probabilities, 'uniform' or the name of a state",
    "start include": "names of states",
    "start exclude": "names of states",
}
READERS: dict[str, Callable[[Preamble, str, Tokens, int, int], None]] = {
    "discount": Preamble._discount,
    "values": Preamble._values,
    "states": Preamble._names,
    "actions": Preamble._names,
    "observations": Preamble._names,
    "start": Preamble._start,
    "start include": Preamble._start,
    "start exclude": Preamble._start,
}
KEYWORDS = frozenset(READERS)
