"""One factor of a model, found by name and printed with the names of its values."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from factored_pomdp.commands.answers import InputError, table
from factored_pomdp.errors import TooLarge, did_you_mean
from factored_pomdp.factors import Factor, NoisyOr
from factored_pomdp.variables import Variable

if TYPE_CHECKING:
    from rich.console import RenderableType

    from factored_pomdp.factors import SparseFactor
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["FoundFactor", "described", "found_factor", "shown_factor"]

_MOST_ROWS = 200
_MOST_COLUMNS = 12
_MOST_ENTRIES = 100_000


@dataclass(frozen=True)
class FoundFactor:
    """A factor, what it is called, and the variable whose distribution it is."""

    title: str
    factor: Factor
    child: Variable | None


def found_factor(model: FactoredPOMDP, name: str) -> FoundFactor:
    """The factor that a name stands for; `InputError` with a suggestion if there is none."""
    listed = {found.title: found for found in _listed(model)}
    short: dict[str, str] = {}
    for title in listed:
        kind, _, own = title.partition(" ")
        if kind not in ("initial", "legal"):
            short.setdefault(own, title)
    title = name if name in listed else short.get(name, "")
    if not title:
        raise InputError(f"{model.name} has no table {name!r}{did_you_mean(name, [*short, *listed])}")
    return listed[title]


def described(found: FoundFactor) -> dict[str, Any]:
    """For JSON: the scope and every entry that is not zero; `TooLarge` where there are too many to print."""
    entries = _entries(found.factor)
    if entries.stored > _MOST_ENTRIES:
        raise TooLarge(f"{found.title} has {entries.stored:,} entries; up to {_MOST_ENTRIES:,} are printed")
    rows = [[*values, number] for values, number in _rows(entries)]
    return {"name": found.title, "scope": found.factor.names, "entries": rows}


def shown_factor(found: FoundFactor) -> list[RenderableType]:
    """A table with a column for every value of the child where they fit, else one row for every entry."""
    try:
        entries = _entries(found.factor)
    except TooLarge as refusal:
        if not isinstance(found.factor, NoisyOr):
            raise
        return [_causes(found.title, found.factor), f"({refusal})"]
    if found.child is not None and found.child.size <= _MOST_COLUMNS and found.factor.size <= _MOST_ENTRIES:
        return _wide(found.title, found.factor, found.child)
    return _long(found.title, entries)


def _listed(model: FactoredPOMDP) -> Iterator[FoundFactor]:
    for name, factor in model.transition.items():
        yield FoundFactor(f"transition {name}.next", factor, model.variable(f"{name}.next"))
    for name, factor in model.observation.items():
        yield FoundFactor(f"observation {name}", factor, model.variable(name))
    for name, factor in model.reward.items():
        yield FoundFactor(f"reward {name}", factor, None)
    for name, factor in model.initial.items():
        yield FoundFactor(f"initial {name}", factor, model.variable(name))
    for name, factor in model.legal.items():
        yield FoundFactor(f"legal {name}", factor, None)


def _entries(factor: Factor) -> SparseFactor:
    if not isinstance(factor, NoisyOr) and factor.stored > 50 * _MOST_ENTRIES:
        raise TooLarge(f"a table of {factor.stored:,} numbers is not printed")
    return factor.sparse()


def _rows(entries: SparseFactor) -> Iterator[tuple[list[Any], float]]:
    order = entries.flat(entries.scope).argsort()
    for position in order:
        index = entries.coordinates[position]
        values = [variable.values[int(i)] for variable, i in zip(entries.scope, index, strict=True)]
        yield values, float(entries.numbers[position])


def _wide(title: str, factor: Factor, child: Variable) -> list[RenderableType]:
    parents = [variable for variable in factor.scope if variable != child]
    numbers = factor.array_over([*parents, child]).reshape(-1, child.size)
    heads = [str(value) for value in child.values]
    made = table(*(parent.name for parent in parents), *heads, title=title, right=heads)
    combinations = itertools.product(*(parent.values for parent in parents))
    for values, line in itertools.islice(zip(combinations, numbers, strict=True), _MOST_ROWS):
        made.add_row(*(str(value) for value in values), *(f"{number:g}" for number in line))
    return [made, *_cut(len(numbers), "rows")]


def _long(title: str, entries: SparseFactor) -> list[RenderableType]:
    made = table(*entries.names, "number", title=f"{title} (entries that are not zero)", right=["number"])
    for values, number in itertools.islice(_rows(entries), _MOST_ROWS):
        made.add_row(*(str(value) for value in values), f"{number:g}")
    return [made, *_cut(entries.stored, "entries")]


def _causes(title: str, factor: NoisyOr) -> RenderableType:
    made = table("cause", "values", "contexts", title=f"{title}: {factor.off!r} unless a cause acts")
    contexts = ", ".join(variable.name for variable in factor.context) or "none"
    for cause in factor.causes:
        name = cause.variable.name if cause.variable is not None else "(always there)"
        made.add_row(name, str(cause.variable.size if cause.variable is not None else 1), contexts)
    return made


def _cut(rows: int, what: str) -> list[str]:
    return [f"… and {rows - _MOST_ROWS:,} more {what} (with --json, all of them)"] if rows > _MOST_ROWS else []
