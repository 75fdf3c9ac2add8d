"""The tables of a ``.pomdp`` file: ``T:``, ``O:`` and ``R:`` in their entry, row and matrix forms."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from factored_pomdp.errors import did_you_mean
from factored_pomdp.files.cassandra.preamble import Preamble
from factored_pomdp.files.cassandra.tokens import Tokens
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.values import lookup
from factored_pomdp.variables import Variable

__all__ = ["LETTERS", "Statements", "after_numbers"]

LETTERS = {"T": "transition", "O": "observation", "R": "reward"}

_FEWEST = {"T": 1, "O": 1, "R": 2}
"""How many names may stand before the numbers, at the least."""


@dataclass
class _Kind:
    """One of the three tables: the variables along its axes, names to positions for each, and what has been said."""

    letter: str
    scope: tuple[Variable, ...]
    layers: Layers = field(init=False)
    positions: tuple[dict[str, int], ...] = field(init=False)

    def __post_init__(self) -> None:
        self.layers = Layers([variable.size for variable in self.scope])
        self.positions = tuple(lookup(variable) for variable in self.scope)


class Statements:
    """Reads the tables, once states, actions and observations are known."""

    def __init__(self, tokens: Tokens, preamble: Preamble, faults: FaultList) -> None:
        self.tokens, self.preamble, self.faults = tokens, preamble, faults
        state, action = preamble.variables["states"], preamble.variables["actions"]
        observation = preamble.variables.get("observations")
        seen = () if observation is None else (observation,)
        self.kinds = {
            "T": _Kind("T", (action, state, state.next)),
            "R": _Kind("R", (action, state, state.next, *seen)),
        }
        if observation is not None:
            self.kinds["O"] = _Kind("O", (action, state.next, observation))

    def read(self, begin: int) -> int:
        """Read statements from a position on; returns the position of the first word that begins none."""
        tokens, end = self.tokens, len(self.tokens)
        while begin + 1 < end and tokens[begin] in LETTERS and tokens[begin + 1] == ":":
            if self.faults.full:
                return end
            kind = self.kinds.get(tokens[begin])
            if kind is None:
                self.faults.note(begin, "O", "an observation table", "'observations:' before it")
                return end
            begin = self._entry(kind, begin) or self._general(kind, begin)
        return begin

    def _entry(self, kind: _Kind, begin: int) -> int:
        """Read the form that nearly every line has: all names, one number. 0 if it is another form, or faulty."""
        tokens, arity = self.tokens, len(kind.scope)
        last = begin + 2 * arity + 1
        try:
            number = float(tokens[last])
            coordinates = [kind.positions[axis][tokens[begin + 2 + 2 * axis]] for axis in range(arity)]
        except (ValueError, KeyError, IndexError):
            return 0
        if not math.isfinite(number) or any(tokens[begin + 3 + 2 * axis] != ":" for axis in range(arity - 1)):
            return 0
        if min(coordinates) >= 0:
            key = 0
            for position, stride in zip(coordinates, kind.layers.strides, strict=True):
                key += position * stride
            kind.layers.point(key, number, begin)
        else:
            kind.layers.scalar(coordinates, number, begin)
        return last + 1

    def _general(self, kind: _Kind, begin: int) -> int:
        """Read any form; returns where the next statement may begin."""
        names = [begin + 2]
        while len(names) < len(kind.scope) and self._word(names[-1] + 1) == ":":
            names.append(names[-1] + 2)
        coordinates = [-1] * len(kind.scope)
        before = len(self.faults)
        for axis, position in enumerate(names):
            coordinates[axis] = self._position(kind, axis, position)
        body = names[-1] + 1
        if len(names) < _FEWEST[kind.letter]:
            self.faults.note(begin, kind.letter, "an action only", "an action and a state before the numbers")
        end = self._body(kind, coordinates, len(names), begin, body, sound=len(self.faults) == before)
        return self._past_surplus(kind, end)

    def _position(self, kind: _Kind, axis: int, position: int) -> int:
        word, variable = self._word(position), kind.scope[axis]
        index = kind.positions[axis].get(word)
        if index is None:
            what = variable.now.name
            article = "an" if what[0] in "ao" else "a"
            found = shortened(word) if position < len(self.tokens) else "the end of the file"
            expected = f"{article} {what}{did_you_mean(word, variable.values)} or *"
            self.faults.note(position, kind.letter, found, expected)
            return -1
        return index

    def _body(self, kind: _Kind, coordinates: list[int], named: int, begin: int, body: int, *, sound: bool) -> int:
        along = tuple(range(named, len(kind.scope)))
        word = self._word(body)
        if word in ("uniform", "identity", "reset") and along and kind.letter != "R":
            if sound:
                self._keyword(kind, word, coordinates, along, begin)
            return body + 1
        expected = math.prod(kind.scope[axis].size for axis in along)
        words = self.tokens[body : body + expected]
        try:
            numbers = np.array(list(map(float, words)))
            complete = len(numbers) == expected
        except ValueError:
            complete = False
        if not complete:
            end = after_numbers(self.tokens, body)
            shape = " × ".join(str(kind.scope[axis].size) for axis in along) or "1"
            found = f"{end - body:,} numbers" if end > body else shortened(word) if word else "the end of the file"
            needed = f"{expected:,} numbers ({shape})" if expected > 1 else "a number"
            self.faults.note(min(body, len(self.tokens) - 1), kind.letter + self._names(begin, named), found, needed)
            return max(end, body)
        if not np.isfinite(numbers).all():
            place = body + int(np.flatnonzero(~np.isfinite(numbers))[0])
            self.faults.note(place, kind.letter, shortened(self.tokens[place]), "a finite number")
        elif sound and along:
            kind.layers.array(coordinates, along, numbers, begin)
        elif sound:
            kind.layers.scalar(coordinates, float(numbers[0]), begin)
        return body + expected

    def _keyword(self, kind: _Kind, word: str, coordinates: list[int], along: tuple[int, ...], begin: int) -> None:
        child = kind.scope[-1]
        if word == "uniform":
            kind.layers.scalar(coordinates, 1 / child.size, begin)
        elif word == "identity" and len(along) == 2 and kind.scope[along[0]].size == child.size:
            kind.layers.diagonal(coordinates, (along[0], along[1]), begin)
        elif word == "reset" and kind.letter == "T":
            kind.layers.array(coordinates, (len(kind.scope) - 1,), self.preamble.belief(), begin)
        else:
            expected = "numbers or 'uniform'" if word == "reset" else "numbers (identity takes a whole square matrix)"
            self.faults.note(begin, kind.letter, word, expected)

    def _past_surplus(self, kind: _Kind, end: int) -> int:
        """Note words up to the next statement that belong to none."""
        after = after_numbers(self.tokens, end)
        if after > end:
            self.faults.note(end, kind.letter, f"{after - end:,} more numbers than expected", "the next statement")
        return after

    def _names(self, begin: int, named: int) -> str:
        return ": " + " : ".join(shortened(self._word(begin + 2 + 2 * axis))[1:-1] for axis in range(named))

    def _word(self, position: int) -> str:
        return self.tokens[position] if position < len(self.tokens) else ""


def after_numbers(tokens: Tokens, begin: int) -> int:
    """The position after a run of numbers."""
    for position in range(begin, len(tokens)):
        try:
            float(tokens[position])
        except ValueError:
            return position
    return len(tokens)
