"""What a step told about the blocks of a stack, as likelihoods to weigh their beliefs with."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from factored_pomdp.beliefs.plan import Seen
from factored_pomdp.beliefs.roster import Members
from factored_pomdp.variables import Value, Variable

__all__ = ["Finding", "findings_of"]


class Finding(NamedTuple):
    """One thing that was looked at in a stack.

    Attributes
    ----------
    own : sequence of str
        For each member, its own name for that thing.
    shown : mapping
        Values by own names; those that are missing were not looked at.
    context : (states,) int
        Row of the likelihood for every joint value of a block.
    likelihood : (rows, members) float
    """

    own: Sequence[str]
    shown: Mapping[str, Value]
    context: np.ndarray
    likelihood: np.ndarray

    def of(self, column: int) -> dict[str, Value]:
        """What one member showed."""
        return {self.own[column]: self.shown[self.own[column]]}


def findings_of(
    members: Members,
    observation: Mapping[str, Value],
    newly: Mapping[str, Value],
    hidden: Mapping[str, Value],
    given: Mapping[str, Value],
    early: bool = False,
) -> list[Finding]:
    """Everything that was looked at, in the order of the plan.

    Parameters
    ----------
    observation : mapping
        Values of observation variables.
    newly : mapping
        Known variables that were read just now.
    hidden : mapping
        Hidden variables that were read back.
    given : mapping
        Known values of both slices, and the action.
    early : bool
        Ask for what tells of the values before the step, in place of those after it.
    """
    plan = members.plan
    found = []
    for seen in plan.seen:
        if seen.early != early:
            continue
        own: Sequence[str] = members.called(seen.child.name)
        shown = observation
        if seen.child.is_next:
            own, shown = [name.removesuffix(".next") for name in own], newly
        values = _positions(seen.child, own, shown)
        if max(values, default=-1) >= 0:
            likelihood = _columns(members, seen, np.array(values, dtype=np.int64), given)
            found.append(Finding(own, shown, seen.context, likelihood))
    for axis, variable in enumerate(plan.variables if hidden else ()):
        own = members.called(variable.name)
        certain = np.concatenate([np.eye(variable.size), np.ones((variable.size, 1))], axis=1)
        likelihood = np.ascontiguousarray(certain[:, _positions(variable, own, hidden)])
        found.append(Finding(own, hidden, np.indices(plan.shape)[axis].ravel(), likelihood))
    return found


def _positions(child: Variable, own: Iterable[str], shown: Mapping[str, Value]) -> list[int]:
    """For each member the position of the value that its own variable showed; -1 where it was not looked at."""
    values = [shown.get(name) for name in own]
    return [-1 if value is None else child.index(value) for value in values]


def _columns(members: Members, seen: Seen, values: np.ndarray, given: Mapping[str, Value]) -> np.ndarray:
    rest = [variable.name for variable in seen.likelihood.rest]
    if not any(name in members.plan.stack.own for name in rest):
        return np.asarray(seen.likelihood.columns(values, given))
    columns = np.empty((int(seen.context.max()) + 1, len(members)))
    for column, names in enumerate(members.names):
        at = {name: given[names.get(name, name)] for name in rest}
        columns[:, [column]] = seen.likelihood.columns(values[[column]], at)
    return columns
