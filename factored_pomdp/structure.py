"""The parts that a model falls into: known variables, and blocks of hidden variables with the factors that touch them.

A state variable is *known* if the agent can tell its value after every step: its start is certain, and it is declared
as read back, or is a function of known variables and actions, or is shown without doubt by an observation. One that is
read back or shown counts as hidden all the same where a transition reads its next value, or where its own transition
reads hidden variables of both slices. Given the known variables, the hidden ones are joined by every factor whose
numbers depend on several of them.

Where a model has terminal states, whoever acts is told after every step that the episode goes on. That is one more
observation (`GOES_ON`), whose likelihood is zero in terminal states and one elsewhere. It falls apart, or joins hidden
variables, as any other: an end when *any* of several things happens is a product, an end when *all* have happened is a
tie. What the others do after the end concerns nobody, so nothing has to freeze for it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from factored_pomdp.components import components
from factored_pomdp.contraction import contract_ancestors
from factored_pomdp.factors import DenseFactor, Factor, NoisyOr
from factored_pomdp.influence import Reducer
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.separation import added_up, additive_parts, multiplicative_parts
from factored_pomdp.validation import is_certain
from factored_pomdp.variables import Value, Variable

__all__ = ["GOES_ON", "Block", "Join", "Structure", "structure_of"]

GOES_ON = Variable("(episode goes on)", [True])
"""What is told after every step that does not end in a terminal state."""


@dataclass(frozen=True)
class Join:
    """A factor that ties several hidden things together.

    Attributes
    ----------
    factor : str
        Such as ``transition of b.next`` or ``reward both``.
    kind : str
        ``initial``, ``transition``, ``observation``, ``reward`` or ``terminal``.
    table : Factor
        Without the variables that make no numeric difference.
    things : tuple of int
        Numbers of the things (groups, or single variables) that it joins.
    """

    factor: str
    kind: str
    table: Factor
    things: tuple[int, ...]


@dataclass(eq=False)
class Block:
    """Hidden variables that belong together, and every factor about them (numerically idle parents left out).

    Attributes
    ----------
    variables : tuple of Variable
        Current-slice state variables.
    transition : dict
        By name of the state variable.
    likelihood : dict
        By name of what is seen: an observation variable, a known variable that hidden ones influence, or `GOES_ON`.
    rewards : list of (name, Factor)
    """

    variables: tuple[Variable, ...]
    transition: dict[str, Factor] = field(default_factory=dict)
    likelihood: dict[str, Factor] = field(default_factory=dict)
    rewards: list[tuple[str, Factor]] = field(default_factory=list)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(variable.name for variable in self.variables)


@dataclass(eq=False)
class Structure:
    """Everything that `decompose`, beliefs and solvers need to know of a model's shape.

    Attributes
    ----------
    known : tuple of str
    functions : dict
        Known variables that are functions of known variables and actions, with that function; one that reads another's
        next value comes after it.
    shown_by : dict
        Known variables that an observation shows, and that observation's name; in an order in which they can be told.
    blocks : tuple of Block
    things : tuple of tuples of str
        Hidden variables in the smallest units that could have stayed apart.
    joins : tuple of Join
        What joined things into blocks.
    laws : dict
        Distributions that no hidden variable influences, of observations and of known variables' next values, by name.
    free_rewards : list of (name, Factor)
        Reward terms over known variables and actions alone.
    running : Factor or None
        Over next known variables: one where the episode goes on. ``None`` where there are no terminal states, or hidden
        variables have a part in them (then blocks hold the likelihood of `GOES_ON`).
    """

    model: FactoredPOMDP
    known: tuple[str, ...]
    functions: dict[str, Factor]
    shown_by: dict[str, str]
    blocks: tuple[Block, ...]
    things: tuple[tuple[str, ...], ...]
    joins: tuple[Join, ...]
    laws: dict[str, Factor]
    free_rewards: list[tuple[str, Factor]]
    running: Factor | None

    def is_over(self, known: Mapping[str, Value | None]) -> bool:
        """Whether known values alone say that the episode is over; those that could not be read say nothing."""
        if self.running is None:
            return False
        at = {variable.name: known.get(variable.now.name) for variable in self.running.scope if variable != GOES_ON}
        return None not in at.values() and not self.running.value({**at, GOES_ON.name: True})


def structure_of(model: FactoredPOMDP) -> Structure:
    """Find known variables, blocks and what joins them, once a model. Cost: one pass over every distinct table."""
    if "structure" not in model.derived:
        model.derived["structure"] = _Finder(model).structure()
    found: Structure = model.derived["structure"]
    return found


class _Finder:
    def __init__(self, model: FactoredPOMDP) -> None:
        self.model, self.states = model, set(model.states)
        reduced = Reducer().reduced
        self.initial = {x: reduced(f, x) for x, f in model.initial.items()}
        self.transition = {x: reduced(f, f"{x}.next") for x, f in model.transition.items()}
        self.observation = {o: reduced(f, o) for o, f in model.observation.items()}
        self.rewards = {r: reduced(f, None) for r, f in model.reward.items()}
        self.running = reduced(_going_on(model.running), GOES_ON.name) if model.running is not None else None
        self.known, self.functions, self.shown_by = self._known()
        if sure := self._sure():
            self.rewards = {r: reduced(f.condition(sure), None) for r, f in self.rewards.items()}
        self.things = self._things()
        self.thing_of = {name: number for number, names in enumerate(self.things) for name in names}

    def structure(self) -> Structure:
        joins: list[Join] = []
        likelihoods: list[tuple[str, Factor, set[int]]] = []
        self._join_initially(joins)
        for name, table in self.transition.items():
            if name in self.known:
                likelihoods += self._seen("transition", f"transition of {name}.next", name, table, joins)
            else:
                self._join("transition", f"transition of {name}.next", table, joins)
        for name, table in self.observation.items():
            likelihoods += self._seen("observation", f"observation of {name}", name, table, joins)
        if self.running is not None:
            likelihoods += self._seen("terminal", "terminal", GOES_ON.name, self.running, joins)
        roots = components(len(self.things), [join.things for join in joins])
        terms, free = self._reward_terms(roots, joins)
        roots = components(len(self.things), [join.things for join in joins])
        blocks = self._blocks(roots, likelihoods, terms)
        order = tuple(variable.name for variable in self.model.states if variable.name in self.known)
        functions = {name: self.transition[name] for name in self.functions}
        laws = self.observation | {f"{name}.next": self.transition[name] for name in order}
        laws = {name: table for name, table in laws.items() if not self._hidden(table)}
        running = self.running if self.running is not None and not self._hidden(self.running) else None
        return Structure(
            self.model, order, functions, self.shown_by, blocks, self.things, tuple(joins), laws, free, running
        )

    def _sure(self) -> dict[str, Value]:
        """Next values of hidden variables that are the same whatever happens."""
        constant = {n: f for n, f in self.transition.items() if n not in self.known and f.names == (f"{n}.next",)}
        laws = {n: (f.scope[0], f.array_over(f.scope)) for n, f in constant.items() if is_certain(f, f"{n}.next")}
        return {after.name: after.values[int(law.argmax())] for after, law in laws.values()}

    def _known(self) -> tuple[set[str], list[str], dict[str, str]]:
        """The largest set of variables that can be told after a step if they were known before it."""
        known = {name for name, factor in self.initial.items() if is_certain(factor, name)}
        group_of: dict[str, set[str]] = {}
        for group in self.model.groups:
            for name in group:
                group_of.setdefault(name, set()).update(group)
        while True:
            functions, shown_by, told = self._told(known)
            left = {n for n in told if group_of.get(n, {n}) <= told}
            left = {n for n in left if {v.name for v in self.initial[n].scope} <= left | {n}}
            if left == known:
                return known, functions, shown_by
            known = left

    def _told(self, known: set[str]) -> tuple[list[str], dict[str, str], set[str]]:
        """Which known variables can be told after a step, one after the other: as functions, read back, shown."""
        read_ahead = {v.name for name, f in self.transition.items() for v in f.scope if v.name != f"{name}.next"}
        functions: list[str] = []
        shown_by: dict[str, str] = {}
        told: set[str] = set()
        while more := [
            n for n in self.transition if n in known and n not in told and self._is_function(n, known, told)
        ]:
            functions += more
            told |= set(more)
        left = [n for n in self.transition if n in known and n not in told and f"{n}.next" not in read_ahead]
        left = [name for name in left if self._reads_one_slice(name, known)]
        told |= self.model.declared_known & set(left)
        while more := [n for n in left if n not in told and self._shown_by(n, told) is not None]:
            shown_by[more[0]] = str(self._shown_by(more[0], told))
            told.add(more[0])
        return functions, shown_by, told

    def _is_function(self, name: str, known: set[str], told: set[str]) -> bool:
        factor = self.transition[name]
        if not is_certain(factor, f"{name}.next"):
            return False
        after = {v.now.name for v in factor.scope if v.is_next} - {name}
        return after <= told and self._reads_known(name, known)

    def _reads_known(self, name: str, known: set[str]) -> bool:
        """Whether all the current-slice state variables that a transition reads are known."""
        return all(v.name in known for v in self.transition[name].scope if v in self.states)

    def _reads_one_slice(self, name: str, known: set[str]) -> bool:
        """Whether the hidden variables that a transition reads are all current, or all of the next slice."""
        parents = [v for v in self.transition[name].scope if v.now in self.states and v.now.name not in known]
        return len({variable.is_next for variable in parents}) <= 1

    def _shown_by(self, name: str, told: set[str]) -> str | None:
        """An observation that no two next values of a variable can give, everything else that it reads being told."""
        after = self.model.variable(name).next
        for seen, factor in self.observation.items():
            hidden = {v.now.name for v in factor.scope if v.is_next} - told - {name}
            if isinstance(factor, NoisyOr) or after not in factor.scope or hidden:
                continue
            possible = factor.sparse()
            others = [variable for variable in possible.scope if variable != after]
            _, times = np.unique(possible.flat(others)[possible.numbers > 0], return_counts=True)
            if (times <= 1).all():
                return seen
        return None

    def _things(self) -> tuple[tuple[str, ...], ...]:
        hidden = [variable.name for variable in self.model.states if variable.name not in self.known]
        number = {name: position for position, name in enumerate(hidden)}
        links = [tuple(number[name] for name in group if name in number) for group in self.model.groups]
        things: dict[int, list[str]] = {}
        for name, root in zip(hidden, components(len(hidden), links), strict=True):
            things.setdefault(root, []).append(name)
        return tuple(tuple(thing) for thing in things.values())

    def _hidden(self, table: Factor) -> dict[int, list[Variable]]:
        """Hidden variables of a scope (either slice) by the thing that they belong to."""
        found: dict[int, list[Variable]] = {}
        for variable in table.scope:
            name = variable.name.removesuffix(".next")
            if name in self.thing_of:
                found.setdefault(self.thing_of[name], []).append(variable)
        return found

    def _join_initially(self, joins: list[Join]) -> None:
        """Initial factors join only what is dependent once they are multiplied out."""
        links = {name: tuple(self._hidden(table)) for name, table in self.initial.items()}
        roots = components(len(self.things), links.values())
        for root in dict.fromkeys(roots[things[0]] for things in links.values() if len(things) > 1):
            members = [number for number, other in enumerate(roots) if other == root]
            groups = [tuple(self.model.variable(name) for name in self.things[number]) for number in members]
            joint = contract_ancestors(self.initial, [variable for group in groups for variable in group])
            groups = [tuple(variable for variable in group if variable in joint.scope) for group in groups]
            for component, part in multiplicative_parts(joint, groups):
                things = tuple(members[number] for number in component)
                if len(things) > 1:
                    factors = [name for name, linked in links.items() if len(linked) > 1 and set(linked) & set(things)]
                    joins.append(Join(f"initial of {', '.join(factors)}", "initial", part, things))

    def _join(self, kind: str, label: str, table: Factor, joins: list[Join]) -> None:
        things = tuple(self._hidden(table))
        if len(things) > 1:
            joins.append(Join(label, kind, table, things))

    def _seen(
        self, kind: str, label: str, name: str, table: Factor, joins: list[Join]
    ) -> list[tuple[str, Factor, set[int]]]:
        hidden = self._hidden(table)
        if not hidden:
            return []
        groups = [tuple(variables) for variables in hidden.values()]
        numbers = list(hidden)
        parts = []
        for component, part in [([0], table)] if len(groups) == 1 else multiplicative_parts(table, groups):
            things = tuple(numbers[number] for number in component)
            parts.append((name, part, set(things)))
            if len(things) > 1:
                joins.append(Join(label, kind, part, things))
        return parts

    def _reward_terms(
        self, roots: list[int], joins: list[Join]
    ) -> tuple[list[tuple[str, Factor, int]], list[tuple[str, Factor]]]:
        terms, free, tied = [], [], []
        for name, table in self.rewards.items():
            by_block: dict[int, list[Variable]] = {}
            shared: list[tuple[Variable, set[int]]] = []
            for variable in table.scope:
                owners = self._blocks_of(variable, roots)
                if len(owners) == 1:
                    by_block.setdefault(owners.pop(), []).append(variable)
                elif owners:
                    shared.append((variable, owners))
            if shared:
                touched = set(by_block).union(*(owners for _, owners in shared))
                joins.append(Join(f"reward {name}", "reward", table, self._things_behind(table)))
                terms.append((name, table, min(touched)))
                continue
            if not by_block:
                free.append((name, table))
                continue
            numbers = list(by_block)
            groups = [tuple(variables) for variables in by_block.values()]
            for component, part in additive_parts(table, groups):
                if len(component) > 1:
                    tied.append((name, part, frozenset(numbers[one] for one in component)))
                else:
                    terms.append((name, part, numbers[component[0]]))
        for name, table, blocks in added_up(tied):
            of_block = {
                block: tuple(v for v in table.scope if self._blocks_of(v, roots) == {block}) for block in blocks
            }
            for component, part in additive_parts(table, list(of_block.values())):
                if len(component) > 1:
                    joins.append(Join(f"reward {name}", "reward", part, self._things_behind(part)))
                terms.append((name, part, list(of_block)[component[0]]))
        return terms, free

    def _blocks_of(self, variable: Variable, roots: list[int]) -> set[int]:
        return {roots[thing] for thing in self._owners(variable, set())}

    def _things_behind(self, table: Factor) -> tuple[int, ...]:
        """Things that a reward reads, or that what it reads depends on."""
        found = set(self._hidden(table))
        for variable in table.scope:
            if variable.now.name not in self.thing_of:
                found |= self._owners(variable, set())
        return tuple(sorted(found))

    def _owners(self, variable: Variable, walked: set[str]) -> set[int]:
        """Things whose current belief the distribution of a variable depends on."""
        name = variable.name.removesuffix(".next")
        owners = {self.thing_of[name]} if name in self.thing_of else set()
        if variable.name in walked:
            return owners
        walked.add(variable.name)
        if variable.name in self.observation:
            parents = self.observation[variable.name].scope
        elif variable.is_next:
            parents = self.transition[name].scope
        else:
            parents = ()
        for parent in parents:
            if parent != variable:
                owners |= self._owners(parent, walked)
        return owners

    def _blocks(
        self, roots: list[int], likelihoods: list[tuple[str, Factor, set[int]]], terms: list[tuple[str, Factor, int]]
    ) -> tuple[Block, ...]:
        members: dict[int, list[Variable]] = {}
        for variable in self.model.states:
            if variable.name in self.thing_of:
                members.setdefault(roots[self.thing_of[variable.name]], []).append(variable)
        blocks = {
            root: Block(tuple(variables), {v.name: self.transition[v.name] for v in variables})
            for root, variables in members.items()
        }
        for name, table, things in likelihoods:
            block = blocks[roots[min(things)]]
            held = block.likelihood.get(name)
            block.likelihood[name] = table if held is None else held.product(table)
        for name, table, thing in terms:
            blocks[roots[thing]].rewards.append((name, table))
        return tuple(blocks.values())


def _going_on(running: Factor) -> DenseFactor:
    """The likelihood of `GOES_ON` in next states."""
    table = running.dense()
    return DenseFactor([*(variable.next for variable in table.scope), GOES_ON], table.array[..., None])
