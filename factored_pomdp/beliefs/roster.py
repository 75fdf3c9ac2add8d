"""Whose columns the arrays of a product belief hold: names, looked up once for all beliefs over the blocks."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from factored_pomdp.beliefs.plan import Plan, StackPlan

__all__ = ["Members", "Names", "Roster"]

Names = dict[str, str]
"""A pattern's names to a block's own."""


@dataclass(frozen=True, eq=False)
class Members:
    """The blocks of one stack, a column each."""

    plan: StackPlan
    names: tuple[Names, ...]
    _called: dict[str, tuple[str, ...]] = field(default_factory=dict, repr=False)

    def __len__(self) -> int:
        return len(self.names)

    def called(self, name: str) -> tuple[str, ...]:
        """What each block calls the pattern's variable of that name."""
        if name not in self._called:
            self._called[name] = tuple(names.get(name, name) for names in self.names)
        return self._called[name]


@dataclass(frozen=True, eq=False)
class Roster:
    """The blocks of all stacks of a plan."""

    plan: Plan
    names: tuple[tuple[Names, ...], ...]

    @cached_property
    def stacks(self) -> tuple[Members, ...]:
        """The same stack by stack."""
        return tuple(Members(plan, names) for plan, names in zip(self.plan.stacks, self.names, strict=True))

    @cached_property
    def blocks(self) -> tuple[tuple[str, ...], ...]:
        """Names of the hidden variables, block by block."""
        return tuple(
            tuple(names[variable.name] for variable in members.plan.variables)
            for members in self.stacks
            for names in members.names
        )

    @cached_property
    def places(self) -> dict[str, tuple[int, int]]:
        """Stack and column of every hidden variable."""
        return {
            names[variable.name]: (number, column)
            for number, members in enumerate(self.stacks)
            for column, names in enumerate(members.names)
            for variable in members.plan.variables
        }

    @cached_property
    def observations(self) -> frozenset[str]:
        """Names of the model's observation variables, and of those of blocks that were added."""
        model = self.plan.structure.model
        own = (members.called(seen.name) for members in self.stacks for seen in members.plan.seen)
        return frozenset({v.name for v in model.observations}.union(*own))
