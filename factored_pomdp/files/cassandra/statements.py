"""The tables of a ``.pomdp`` file: ``T:``, ``O:`` and ``R:`` in their entry, row and matrix forms."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from factored_pomdp.files.cassandra.preamble import Preamble
from factored_pomdp.files.cassandra.tokens import Tokens
from factored_pomdp.files.faults import FaultList, shortened
from factored_pomdp.files.layers import Layers
from factored_pomdp.files.values import lookup, near
from factored_pomdp.variables import Variable

__all__ = ["LETTERS", "Statements", "after_numbers"]

LETTERS = {"T": "transition", "O": "observation", "R": "reward"}

_FEWEST = {"T": 1, "O": 1, "R": 2}
"""How many names may stand before the numbers, at the least."""


_MOST_AT_ONCE = 1 << 16
_MOST_TOLD = 20
"""Words of one statement that are listed one by one."""


@dataclass(frozen=True)
class _Kind:
    """One of the three tables: the variables along its axes, names to positions for each, and what has been said."""

    letter: str
    scope: tuple[Variable, ...]
    positions: tuple[dict[str, int], ...]
    layers: Layers


class Statements:
    """Reads the tables, once states, actions and observations are known."""

    def __init__(self, tokens: Tokens, preamble: Preamble, faults: FaultList) -> None:
        self.tokens, self.preamble, self.faults = tokens, preamble, faults
        self._hoped = 8
        variables = preamble.variables
        positions = {variable.name: lookup(variable) for variable in variables.values()}
        state, action = variables["states"], variables["actions"]
        seen = (variables["observations"],) if "observations" in variables else ()
        scopes: dict[str, tuple[Variable, ...]] = {"T": (action, state, state.next)}
        if not preamble.lost("observations"):
            scopes["R"] = (action, state, state.next, *seen)
        if seen:
            scopes["O"] = (action, state.next, *seen)
        self.kinds = {
            letter: _Kind(letter, scope, tuple(positions[v.now.name] for v in scope), Layers([v.size for v in scope]))
            for letter, scope in scopes.items()
        }

    def read(self, begin: int) -> int:
        """Read statements from a position on; returns the position of the first word that begins none."""
        tokens, end = self.tokens, len(self.tokens)
        while begin + 1 < end and tokens[begin] in LETTERS and tokens[begin + 1] == ":":
            if self.faults.full:
                return end
            kind = self.kinds.get(tokens[begin])
            if kind is None:
                if not self.preamble.lost("observations"):
                    self.faults.note(begin, "O", "an observation table", "'observations:' before it")
                    self.preamble.was_meant("observations")
                    self.kinds.pop("R")
                begin = tokens.table_end(begin)
                continue
            begin = self._run(kind, begin) or self._general(kind, begin)
        return begin

    def _run(self, kind: _Kind, begin: int) -> int:
        """Read a run of statements of the form that nearly every line has: all names, one number.

        As many as hoped for are read at once, or none (0); the hope grows as it is met.
        """
        arity = len(kind.scope)
        step = 2 * arity + 2
        words = self.tokens[begin : begin + step * self._hoped]
        number = len(words) // step
        del words[number * step :]
        colons = (words[1 + 2 * axis :: step].count(":") == number for axis in range(arity))
        try:
            if not number or words[::step].count(kind.letter) < number or not all(colons):
                raise ValueError
            columns = [
                list(map(known.__getitem__, words[2 + 2 * axis :: step])) for axis, known in enumerate(kind.positions)
            ]
            numbers = np.array(list(map(float, words[step - 1 :: step])))
            if not np.isfinite(numbers).all():
                raise ValueError
        except (KeyError, ValueError):
            self._hoped = max(1, self._hoped // 8)
            return 0
        self._hoped = min(4 * self._hoped, _MOST_AT_ONCE)
        stamps = begin + step * np.arange(number, dtype=np.int64)
        kind.layers.scalars(np.array(columns, dtype=np.int64).T, numbers, stamps)
        return begin + number * step

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
        end = self._past_surplus(kind, end, told=len(self.faults) > before)
        if len(self.faults) > before:
            places = zip(names, kind.positions[:-1], strict=False)
            certain = all(self._word(position) in known for position, known in places)
            kind.layers.doubts.add(coordinates, begin, certain=certain)
        return end

    def _position(self, kind: _Kind, axis: int, position: int) -> int:
        word, variable = self._word(position), kind.scope[axis]
        index = kind.positions[axis].get(word)
        if index is None:
            what = variable.now.name
            article = "an" if what[0] in "ao" else "a"
            found = shortened(word) if position < len(self.tokens) else "the end of the file"
            expected = f"{article} {what}{near(word, variable.values)} or *"
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
            needed = f"{expected:,} numbers ({' × '.join(str(kind.scope[axis].size) for axis in along)})"
            return self._past_incomplete(kind.letter + self._names(begin, named), body, needed if along else "a number")
        if not np.isfinite(numbers).all():
            for place in (body + np.flatnonzero(~np.isfinite(numbers))[:_MOST_TOLD]).tolist():
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

    def _past_incomplete(self, where: str, body: int, needed: str) -> int:
        """Note that numbers are missing, or the words that stand in their place; returns where the statement ends."""
        end = self.tokens.statement_end(min(body, len(self.tokens)))
        wrong = after_numbers(self.tokens, body)
        told = 0
        while wrong < end and told < _MOST_TOLD:
            self.faults.note(wrong, where, shortened(self.tokens[wrong]), needed)
            wrong, told = after_numbers(self.tokens, wrong + 1), told + 1
        if not told:
            found = f"{end - body:,} numbers" if end < len(self.tokens) or end > body else "the end of the file"
            self.faults.note(min(body, len(self.tokens) - 1), where, found, needed)
        return end

    def _past_surplus(self, kind: _Kind, end: int, *, told: bool) -> int:
        """Note numbers up to the next statement that belong to none (unless something else was wrong already)."""
        after = after_numbers(self.tokens, end)
        if after > end and not told:
            number = "many" if self.tokens.cut and after == len(self.tokens) else f"{after - end:,}"
            self.faults.note(end, kind.letter, f"{number} more numbers than expected", "the next statement")
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
