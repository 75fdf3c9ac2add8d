"""Whose columns the arrays of a product belief hold: names, looked up once for all beliefs over the blocks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

from factored_pomdp.beliefs.plan import Plan, StackPlan
from factored_pomdp.errors import did_you_mean
from factored_pomdp.structure import GOES_ON

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

    def template(self, names: Mapping[str, str]) -> tuple[int, Names]:
        """Stack and names of a block, in the belief or else in the model, that has some variables of these names."""
        listed = [(number, own) for number, some in enumerate(self.names) for own in some]
        listed += [(number, own) for number, plan in enumerate(self.plan.stacks) for own in plan.stack.names]
        for number, existing in listed:
            if {existing[variable.name] for variable in self.plan.stacks[number].variables} & names.keys():
                return number, existing
        meant = did_you_mean(next(iter(names), ""), self.places)
        raise ValueError(f"none of {', '.join(names)} is in the belief: name variables of a block in it{meant}")

    def renamed(self, stack: int, existing: Names, names: Mapping[str, str]) -> Names:
        """The names of one more block in a stack.

        Raises
        ------
        ValueError
            Where a name is taken, unknown, or missing.
        """
        plan = self.plan.stacks[stack]
        own = {existing.get(name, name) for name in (*existing, *(seen.name for seen in plan.seen))}
        own = {name for name in own if not name.endswith(".next")}
        if unknown := [name for name in names if name not in own]:
            raise ValueError(f"{unknown[0]!r} is no name of that block{did_you_mean(unknown[0], sorted(own))}")
        fresh = {pattern: names.get(name, name) for pattern, name in existing.items()}
        fresh |= {variable.next.name: f"{fresh[variable.name]}.next" for variable in plan.variables}
        states = [fresh[variable.name] for variable in plan.variables]
        if taken := sorted({name for name in states if name in self.places or states.count(name) > 1}):
            raise ValueError(f"{', '.join(taken)} is in the belief already")
        looked = [seen.name for seen in plan.seen if not seen.child.is_next and seen.child != GOES_ON]
        seen_of = [fresh.get(name, names.get(name, name)) for name in looked]
        if taken := sorted({name for name in seen_of if name in self._seen or seen_of.count(name) > 1}):
            raise ValueError(f"the new block needs observation variables of its own in place of {', '.join(taken)}")
        return fresh

    @cached_property
    def _seen(self) -> frozenset[str]:
        """Observation variables of the blocks in the belief."""
        return frozenset().union(*(members.called(s.name) for members in self.stacks for s in members.plan.seen))

    @cached_property
    def observations(self) -> frozenset[str]:
        """Names of the model's observation variables, and of those of blocks that were added."""
        model = self.plan.structure.model
        own = (members.called(seen.name) for members in self.stacks for seen in members.plan.seen)
        return frozenset({v.name for v in model.observations}.union(*own))
