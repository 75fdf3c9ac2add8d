"""Variables: a name and the values that it can take."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Hashable, Iterable
from functools import cached_property

from factored_pomdp.errors import did_you_mean

__all__ = ["Value", "Variable", "count"]

Value = Hashable

_NEXT = ".next"


class Variable:
    """A discrete variable.

    Parameters
    ----------
    name : str
        Unique within a model. The ending ``.next`` belongs to the next slice.
    values : iterable of hashable
        At least one, no two equal, and not ``None``, which stands for "not read" and "not looked at".

    Raises
    ------
    ValueError
        Naming the value that is wrong.

    Examples
    --------
    >>> weather = Variable("weather", ["sun", "rain"])
    >>> weather.next
    Variable('weather.next', 2 values)
    >>> weather.index("rain")
    1
    """

    __slots__ = ("__dict__", "_indexes", "name", "values")

    def __init__(self, name: str, values: Iterable[Value]) -> None:
        self.name = name
        self.values: tuple[Value, ...] = values if isinstance(values, tuple) else tuple(values)
        if not name:
            raise ValueError("a variable needs a name")
        if not self.values:
            raise ValueError(f"variable {name!r} has no values; it needs at least one")
        if any(value is None for value in self.values):
            raise ValueError(f"variable {name!r} has the value None, which means 'not read'; give that value a name")
        try:
            self._indexes = {value: index for index, value in enumerate(self.values)}
        except TypeError as problem:
            raise ValueError(f"variable {name!r}: {problem}; values must be hashable, such as tuples") from None
        if len(self._indexes) != len(self.values):
            twice = next(value for value, times in Counter(self.values).items() if times > 1)
            raise ValueError(f"variable {name!r} has the value {twice!r} more than once")

    @property
    def size(self) -> int:
        """How many values there are."""
        return len(self.values)

    def index(self, value: object) -> int:
        """Position of a value; ``ValueError`` names the values that there are."""
        try:
            return self._indexes[value]
        except (KeyError, TypeError):
            raise ValueError(f"{self.name!r} has no value {value!r}{did_you_mean(value, self.values)}") from None

    @property
    def is_next(self) -> bool:
        """Whether this is the next slice's twin of a state variable."""
        return self.name.endswith(_NEXT)

    @cached_property
    def next(self) -> Variable:
        """The same variable one step later."""
        if self.is_next:
            raise ValueError(f"{self.name!r} is of the next slice already")
        return self.renamed(self.name + _NEXT)

    @property
    def now(self) -> Variable:
        """The same variable in the current slice."""
        return self.renamed(self.name.removesuffix(_NEXT)) if self.is_next else self

    def renamed(self, name: str) -> Variable:
        """The same values under another name."""
        twin = object.__new__(Variable)
        twin.name, twin.values, twin._indexes = name, self.values, self._indexes
        return twin

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Variable):
            return NotImplemented
        return self.name == other.name and (self.values is other.values or self.values == other.values)

    def __hash__(self) -> int:
        return hash(self.name)

    def __repr__(self) -> str:
        return f"Variable({self.name!r}, {self.size} value{'s' if self.size != 1 else ''})"


def count(variables: Iterable[Variable]) -> int:
    """Number of joint assignments of some variables (1 for none)."""
    return math.prod(variable.size for variable in variables)
