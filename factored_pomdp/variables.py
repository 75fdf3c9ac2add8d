"""Variables: a name and the values that it can take."""

from __future__ import annotations

import math
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
        At least one, no two equal.

    Examples
    --------
    >>> weather = Variable("weather", ["sun", "rain"])
    >>> weather.next
    Variable('weather.next', 2 values)
    >>> weather.index("rain")
    1
    """

    __slots__ = ("__dict__", "name", "values")

    def __init__(self, name: str, values: Iterable[Value]) -> None:
        self.name = name
        self.values: tuple[Value, ...] = values if isinstance(values, tuple) else tuple(values)
        if not name:
            raise ValueError("a variable needs a name")
        if not self.values:
            raise ValueError(f"variable {name!r} has no values; it needs at least one")

    @property
    def size(self) -> int:
        """How many values there are."""
        return len(self.values)

    @cached_property
    def _indexes(self) -> dict[Value, int]:
        indexes = {value: index for index, value in enumerate(self.values)}
        if len(indexes) != len(self.values):
            twice = next(value for value in self.values if self.values.count(value) > 1)
            raise ValueError(f"variable {self.name!r} has the value {twice!r} more than once")
        return indexes

    def index(self, value: Value) -> int:
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
        twin = Variable(self.name + _NEXT, self.values)
        twin.__dict__["_indexes"] = self._indexes
        return twin

    @property
    def now(self) -> Variable:
        """The same variable in the current slice."""
        return Variable(self.name.removesuffix(_NEXT), self.values) if self.is_next else self

    def renamed(self, name: str) -> Variable:
        """The same values under another name."""
        twin = Variable(name, self.values)
        if "_indexes" in self.__dict__:
            twin.__dict__["_indexes"] = self._indexes
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
