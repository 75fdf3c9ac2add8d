"""The three ways to write a factor down: a function of named values, a nested mapping, an array with named axes."""

from __future__ import annotations

import inspect
import itertools
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from factored_pomdp.errors import Fault, TooLarge, did_you_mean
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor
from factored_pomdp.factors.base import MAX_ENTRIES
from factored_pomdp.variables import Variable, count

__all__ = ["Specification", "Table", "resolve", "table"]

_SPARSE_FROM = 100_000
_SPARSE_BELOW = 0.25


@dataclass(frozen=True)
class Table:
    """Numbers together with the names of their axes; made by `table`."""

    axes: tuple[str, ...]
    values: Any


Specification = Factor | Table | Callable[..., Any] | Mapping[Any, Any] | float


def table(*axes: str | Variable, values: Any) -> Table:
    """Name the axes of an array, the levels of a nested mapping, or the arguments of a function.

    A distribution's own variable is the last axis of an array or a mapping, and no argument of a function.

    Parameters
    ----------
    *axes : str or Variable
        Such as ``"weather", "weather.next"``.
    values : array_like, nested mapping or callable

    Examples
    --------
    >>> table("weather", "weather.next", values=[[0.8, 0.2], [0.4, 0.6]]).axes
    ('weather', 'weather.next')
    """
    return Table(tuple(axis.name if isinstance(axis, Variable) else axis for axis in axes), values)


class _NotResolvable(Exception):
    def __init__(self, found: str, expected: str, *more: tuple[str, str, str]) -> None:
        self.faults = [("", found, expected), *more] if found else list(more)


def resolve(
    specification: Any, child: Variable | None, variables: Mapping[str, Variable], where: str, faults: list[Fault]
) -> Factor | None:
    """A factor over known variables, or ``None`` after its faults were noted.

    Parameters
    ----------
    child : Variable or None
        The variable whose distribution this is; ``None`` for a reward.
    variables : mapping
        Every variable that may stand in the scope, by name.
    """
    try:
        if isinstance(specification, Factor):
            return _checked(specification, child, variables)
        if isinstance(specification, Table):
            return _from_axes(specification, child, variables)
        if callable(specification):
            return _from_function(_parameters(specification, variables), specification, child)
        if child is not None and _is_value(specification, child):
            return DeterministicFactor((), child, child.index(specification))
        if child is not None and isinstance(specification, Mapping | list | tuple | np.ndarray):
            return _from_axes(Table((child.name,), specification), child, variables)
        if child is None and isinstance(specification, int | float):
            return DenseFactor((), float(specification))
        raise _NotResolvable(repr(specification), "a function, a fp.table(…), a Factor or a value")
    except _NotResolvable as problem:
        faults += [Fault(where + at, found, expected) for at, found, expected in problem.faults]
    except (ValueError, TypeError) as problem:
        faults.append(Fault(where, str(problem), "values and shapes of the variables it names"))
    return None


def _checked(factor: Factor, child: Variable | None, variables: Mapping[str, Variable]) -> Factor:
    for variable in factor.scope:
        if variable.name not in variables:
            raise _NotResolvable(
                f"the unknown variable {variable.name!r}", f"one of the model's{_near(variable.name, variables)}"
            )
        if variables[variable.name] != variable:
            raise _NotResolvable(f"another {variable.name!r} with {variable.size} values", "the model's own variable")
    if child is not None and child not in factor.scope:
        raise _NotResolvable(f"a factor over {', '.join(factor.names) or 'nothing'}", f"{child.name} in its scope")
    return factor


def _from_axes(named: Table, child: Variable | None, variables: Mapping[str, Variable]) -> Factor:
    unknown = [name for name in named.axes if name not in variables]
    if unknown:
        what = "variable" if len(unknown) == 1 else "variables"
        near = _near(unknown[0], variables)
        raise _NotResolvable(f"the unknown {what} {_listed(unknown)}", f"one of the model's{near}")
    if len(set(named.axes)) != len(named.axes):
        raise _NotResolvable(f"axes {', '.join(named.axes)}", "every axis once")
    scope = [variables[name] for name in named.axes]
    if callable(named.values):
        return _from_function([variable for variable in scope if variable != child], named.values, child)
    if child is not None and (not scope or scope[-1] != child):
        raise _NotResolvable(f"axes {', '.join(named.axes) or 'none'}", f"{child.name} as the last axis")
    shape = [variable.size for variable in scope]
    if isinstance(named.values, Mapping):
        if count(scope) > MAX_ENTRIES:
            raise TooLarge(f"a full table over {', '.join(named.axes)} would hold {count(scope):,} numbers")
        array = np.zeros(shape)
        _fill(array, (), named.values, scope, filled_up=child is not None)
    else:
        try:
            array = np.asarray(named.values, dtype=float)
        except (TypeError, ValueError):
            expected = f"numbers in shape {tuple(shape)} for ({', '.join(named.axes)})"
            raise _NotResolvable("rows of different lengths, or values that are no numbers", expected) from None
    if list(array.shape) != shape:
        raise _NotResolvable(f"an array of shape {array.shape}", f"shape {tuple(shape)} for ({', '.join(named.axes)})")
    return DenseFactor(scope, array)


def _fill(array: np.ndarray, index: tuple[int, ...], level: Any, scope: list[Variable], *, filled_up: bool) -> None:
    if len(index) == len(scope):
        try:
            array[index] = float(level)
        except (TypeError, ValueError):
            raise _NotResolvable(f"{level!r}{_after(scope, index)}", "a number") from None
        return
    variable = scope[len(index)]
    if not isinstance(level, Mapping):
        raise _NotResolvable(f"{level!r} where values of {variable.name!r} are listed", "a mapping at this level")
    for value, below in level.items():
        _fill(array, (*index, variable.index(value)), below, scope, filled_up=filled_up)
    absent = [value for value in variable.values if value not in level]
    last = len(index) == len(scope) - 1
    if absent and not (last and filled_up):
        raise _NotResolvable(f"no entry for {variable.name}={absent[0]!r}{_after(scope, index)}", "every value listed")


def _after(scope: list[Variable], index: tuple[int, ...]) -> str:
    at = ", ".join(f"{v.name}={v.values[i]}" for v, i in zip(scope, index, strict=False))
    return f" at {at}" if at else ""


def _parameters(function: Callable[..., Any], variables: Mapping[str, Variable]) -> list[Variable]:
    """A parameter ``weather_next`` or ``robot_place`` stands for the variable ``weather.next`` or ``robot.place``."""
    by_parameter: dict[str, list[Variable]] = {}
    for name, variable in variables.items():
        by_parameter.setdefault(name.replace(".", "_"), []).append(variable)
    parameters = list(inspect.signature(function).parameters)
    unknown = [name for name in parameters if name not in by_parameter]
    if unknown:
        near = _near(unknown[0], by_parameter)
        raise _NotResolvable(f"a function of the unknown {_listed(unknown)}", f"parameters named as variables{near}")
    for name in parameters:
        if len(by_parameter[name]) > 1:
            either = " or ".join(variable.name for variable in by_parameter[name])
            raise _NotResolvable(f"the parameter {name!r}", f"fp.table(…) with names of axes, as it may mean {either}")
    return [by_parameter[name][0] for name in parameters]


def _listed(names: list[str]) -> str:
    return ", ".join(repr(name) for name in names)


def _from_function(parents: list[Variable], function: Callable[..., Any], child: Variable | None) -> Factor:
    scope = [*parents, child] if child is not None else parents
    if count(parents) > MAX_ENTRIES // 10:
        raise TooLarge(f"a function of {', '.join(v.name for v in parents)} would be called {count(parents):,} times")
    shape = [parent.size for parent in parents]
    results: list[Any] = []
    problems: list[tuple[str, str, str]] = []
    for values in itertools.product(*(parent.values for parent in parents)):
        try:
            results.append(_read(function(*values), child))
        except Exception as problem:
            at = ", ".join(f"{parent.name}={value}" for parent, value in zip(parents, values, strict=True))
            found = str(problem) if isinstance(problem, _Unreadable) else f"{type(problem).__name__} ({problem})"
            problems.append(
                (f" at {at}" if at else "", found, "a number" if child is None else f"values of {child.name!r}")
            )
    if problems:
        raise _NotResolvable("", "", *problems)
    if child is None:
        return DenseFactor(scope, np.array(results).reshape(shape))
    if not any(isinstance(result, dict) for result in results):
        return DeterministicFactor(parents, child, np.array(results).reshape(shape))
    spread = [result if isinstance(result, dict) else {result: 1.0} for result in results]
    rows = [row for row, result in enumerate(spread) for _ in result]
    columns = [column for result in spread for column in result]
    numbers = [number for result in spread for number in result.values()]
    entries = count(scope)
    flat = np.array(rows, dtype=np.int64) * child.size + np.array(columns, dtype=np.int64)
    from factored_pomdp.factors.sparse import SparseFactor, unflatten

    stored = SparseFactor(scope, unflatten(flat, tuple(scope)), numbers)
    if entries > _SPARSE_FROM and len(numbers) < _SPARSE_BELOW * entries:
        return stored
    return stored.dense()


class _Unreadable(ValueError):
    """What a function returned is no number, value or distribution."""


def _read(result: Any, child: Variable | None) -> float | int | dict[int, float]:
    """A reward; or the position of a child's value; or probabilities by position."""
    try:
        if child is None:
            return float(result)
        if isinstance(result, Mapping):
            return {child.index(value): float(probability) for value, probability in result.items()}
        return child.index(result)
    except (TypeError, ValueError) as problem:
        raise _Unreadable(f"{result!r} ({problem})") from None


def _near(name: str, variables: Mapping[str, Any]) -> str:
    later = next((other for other in (f"{name}_next", f"{name}.next") if other in variables), None)
    if later is not None:
        return f" (did you mean {later!r}?)"
    return did_you_mean(name, variables)


def _is_value(specification: Any, child: Variable) -> bool:
    try:
        child.index(specification)
    except ValueError:
        return False
    return True
