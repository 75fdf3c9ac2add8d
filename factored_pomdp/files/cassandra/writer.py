"""Writes Cassandra's ``.pomdp`` format; numbers are written so that reading gives them back exactly."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from factored_pomdp.factors import DenseFactor, Factor
from factored_pomdp.files.cassandra.preamble import KEYWORDS
from factored_pomdp.files.cassandra.statements import LETTERS
from factored_pomdp.files.flatten import flattened
from factored_pomdp.files.names import counted, words
from factored_pomdp.files.sums import with_base
from factored_pomdp.files.text import write_text
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Variable

__all__ = ["write_cassandra"]

RESERVED = {"uniform", "identity", "reset", "include", "exclude", "reward", "cost", *LETTERS, *KEYWORDS}

_MATRIX_FROM = 0.4
"""Share of numbers that are not zero from which on a table is written as matrices."""


def write_cassandra(model: FactoredPOMDP, path: Path) -> None:
    """Write a model; one of several variables is flattened first (see `flattened`, and what it raises)."""
    flat = flattened(model)
    write_text(path, _parts(flat))


def _parts(model: FactoredPOMDP) -> Iterator[str]:
    (state,), (action,) = model.states, model.actions
    names = {variable.name: _words(variable) for variable in (state, action, *model.observations)}
    names[state.next.name] = names[state.name]
    reward, *exceptions = model.reward.values()
    yield f"discount: {float(model.discount)!r}\nvalues: reward\n"
    yield f"states: {_listed(names[state.name])}\nactions: {_listed(names[action.name])}\n"
    seen = model.observations
    if seen:
        yield f"observations: {_listed(names[seen[0].name])}\n"
    elif state.name not in model.declared_known:
        yield "observations: nothing\n"
    start = np.broadcast_to(model.initial[state.name].array_over([state]), [state.size])
    yield "start: " + " ".join(map(repr, start.tolist())) + "\n"
    yield from _table("T", model.transition[state.name], (action, state, state.next), names)
    if seen:
        yield from _table("O", model.observation[seen[0].name], (action, state.next, seen[0]), names)
    elif state.name not in model.declared_known:
        yield "\nO: * : * : nothing 1.0\n"
    stars = " : *" if not seen and state.name not in model.declared_known else ""
    scope = (action, state, state.next, *seen)
    yield from _table("R", reward, scope, names, stars)
    for differences in exceptions:
        yield from _table("R", with_base(reward, differences.sparse()), scope, names, stars)


def _table(
    letter: str, factor: Factor, scope: tuple[Variable, ...], names: dict[str, list[str]], stars: str = ""
) -> Iterator[str]:
    yield "\n"
    if isinstance(factor, DenseFactor) and letter != "R" and set(scope[1:]) <= set(factor.scope):
        table = factor.array_over(scope)
        if np.count_nonzero(table) >= _MATRIX_FROM * table.size:
            actions = names[scope[0].name] if scope[0] in factor.scope else ["*"]
            for action, matrix in zip(actions, table, strict=True):
                yield f"{letter}: {action}\n"
                yield from (" ".join(map(repr, row)) + "\n" for row in matrix.tolist())
            return
    sparse = factor.sparse()
    present = [variable for variable in scope if variable in sparse.scope]
    coordinates = sparse.coordinates[:, [sparse.scope.index(variable) for variable in present]]
    order = np.lexsort(coordinates.T[::-1]) if present else np.arange(len(sparse.numbers))
    columns = []
    for variable in scope:
        if variable in present:
            column = coordinates[order, present.index(variable)]
            columns.append(np.array(names[variable.name], dtype=object)[column].tolist())
        else:
            columns.append(["*"] * len(order))
    for *places, number in zip(*columns, sparse.numbers[order].tolist(), strict=True):
        yield f"{letter}: {' : '.join(places)}{stars} {number!r}\n"


def _words(variable: Variable) -> list[str]:
    if counted(variable.values):
        return [str(position) for position in range(variable.size)]
    return words(variable.values, RESERVED, begin=variable.name[0] if variable.name[0].isalpha() else "v")


def _listed(names: list[str]) -> str:
    return str(len(names)) if counted(names) else " ".join(names)
