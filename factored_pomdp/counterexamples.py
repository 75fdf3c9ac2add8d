"""Numbers that show a tie: worked out on the tied block alone, from beliefs with a few values each.

Initial tie: a joint probability that is not the product of the marginals. Transition, observation or terminal tie: a
posterior (given that the episode goes on) that is not the product of its marginals although the belief was one, or two
beliefs that agree on one thing whose posteriors differ there. Reward tie: four expected rewards whose mixed difference
is not zero.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property, reduce
from typing import Any

import numpy as np

from factored_pomdp.contraction import contract, contract_ancestors
from factored_pomdp.factors import Factor, SparseFactor, constant
from factored_pomdp.influence import influence
from factored_pomdp.structure import GOES_ON, Block, Join, Structure
from factored_pomdp.variables import Value, Variable

__all__ = ["counterexample_of"]

_SHOWS = 1e-6
_TRIALS = 30
_SEED = 0

Belief = dict[str, dict[Value, float]]
Counterexample = dict[str, Any]


def counterexample_of(structure: Structure, join: Join) -> Counterexample | None:
    """A counterexample of the join's own kind, or ``None`` if none was found in a bounded search."""
    if join.kind == "initial":
        return _not_a_product(join.table, [structure.things[n] for n in join.things], {"kind": "belief"})
    search = _Search(structure, join)
    if join.kind == "reward":
        return search.value()
    if join.kind == "terminal":
        return search.posterior() or search.start()
    return search.posterior()


def _not_a_product(table: Factor, things: list[tuple[str, ...]], said: Counterexample) -> Counterexample | None:
    """The assignment at which a joint probability differs most from the product of the things' marginals."""
    sparse = table.sparse()
    groups = [tuple(v for v in sparse.scope if v.name in thing) for thing in things]
    groups = [group for group in groups if group]
    rest = [variable for variable in sparse.scope if not any(variable in group for group in groups)]
    joint = sparse.marginalise(*rest) if rest else sparse
    joint = joint.product(constant(1 / float(joint.numbers.sum()))).sparse()
    parts = [joint.marginalise(*(v for v in joint.scope if v not in group)) for group in groups]
    product = reduce(lambda a, b: a.join(b), parts)
    ours = dict(zip(joint.flat(joint.scope).tolist(), joint.numbers.tolist(), strict=True))
    keys = product.flat(joint.scope).tolist()
    differences = [abs(ours.get(key, 0.0) - number) for key, number in zip(keys, product.numbers, strict=True)]
    worst = int(np.argmax(differences)) if differences else -1
    if worst < 0 or differences[worst] <= _SHOWS:
        return None
    at = {v.name: v.values[int(i)] for v, i in zip(product.scope, product.coordinates[worst], strict=True)}
    return {**said, "at": at, "joint": ours.get(keys[worst], 0.0), "product": float(product.numbers[worst])}


class _Search:
    """Tries beliefs near the values at which the tying factor shows its dependence."""

    def __init__(self, structure: Structure, join: Join) -> None:
        self.structure, self.join, self.model = structure, join, structure.model
        self.things = [structure.things[number] for number in join.things]
        tied = {name for thing in self.things for name in thing}
        self.blocks = [block for block in structure.blocks if tied & set(block.names)]
        self.block = Block(
            tuple(v for block in self.blocks for v in block.variables),
            {n: f for block in self.blocks for n, f in block.transition.items()},
            {n: f for block in self.blocks for n, f in block.likelihood.items()},
        )
        self.hidden = {variable.name: variable for variable in self.block.variables}
        self.seen = {GOES_ON.name, *(variable.name for variable in self.model.observations)}
        self.rng = np.random.default_rng(_SEED)

    def posterior(self) -> Counterexample | None:
        for any_belief, others in self._beliefs():
            context = self._context(others)
            belief = self._going_on(any_belief, context)
            if belief is None:
                continue
            predicted = self._predicted(belief, context)
            observed = self._observation(predicted, context, others)
            after = self._posterior(predicted, context, observed)
            if after is None:
                continue
            said = {"kind": "posterior", "belief": belief, **context, "observation": observed}
            found = _not_a_product(after, self.things, said)
            if found is None:
                found = self._dependence(belief, context, observed, after)
            if found is not None:
                return found
        return None

    def start(self) -> Counterexample | None:
        """The initial belief, given that the episode goes on at all."""
        running = self._running
        if running is None:
            return None
        joint = contract_ancestors(self.model.initial, list(dict.fromkeys([*self.hidden.values(), *running.scope])))
        going_on = joint.product(running).sparse()
        return _not_a_product(going_on, self.things, {"kind": "belief"}) if going_on.numbers.sum() > 0 else None

    def value(self) -> Counterexample | None:
        """Expected rewards of four beliefs that differ in one thing each."""
        for (any_belief, others), (first, second) in itertools.product(
            self._beliefs(), itertools.combinations(self.things, 2)
        ):
            context = self._context(others)
            belief = self._going_on(any_belief, context)
            if belief is None:
                continue
            numbers: dict[tuple[int, int], float] = {}
            for one, two in itertools.product((0, 1), repeat=2):
                changed = dict(belief)
                for name in (*first, *second):
                    ends_of = list(belief[name])
                    pick = ends_of[min(one if name in first else two, len(ends_of) - 1)]
                    changed[name] = {pick: 1.0}
                numbers[one, two] = self._expected(changed, context)
            mixed = numbers[0, 0] + numbers[1, 1] - numbers[0, 1] - numbers[1, 0]
            if abs(mixed) > _SHOWS:
                ends = {name: list(belief[name]) for name in (*first, *second)}
                rest = {name: masses for name, masses in belief.items() if name not in ends}
                values = {f"{one}{two}": number for (one, two), number in numbers.items()}
                return {
                    "kind": "value",
                    "ends": ends,
                    "belief": rest,
                    **context,
                    "values": values,
                    "mixed_difference": mixed,
                }
        return None

    def _dependence(
        self, belief: Belief, context: Mapping[str, Any], observed: Mapping[str, Value], after: Factor
    ) -> Counterexample | None:
        """Change the belief of one thing and see whether another's posterior changes."""
        for changed, watched in itertools.permutations(self.things, 2):
            other = dict(belief)
            for name in changed:
                other[name] = {list(belief[name])[-1]: 1.0}
            second = self._posterior(self._predicted(other, context), context, observed)
            if second is None:
                continue
            kept = [self.hidden[name] for name in watched]
            one, two = (_marginal(table, kept) for table in (after, second))
            where = int(np.abs(one - two).argmax())
            if abs(one.ravel()[where] - two.ravel()[where]) > _SHOWS:
                index = np.unravel_index(where, one.shape)
                at = {v.name: v.values[int(i)] for v, i in zip(kept, index, strict=True)}
                return {
                    "kind": "two beliefs",
                    "belief": belief,
                    "other_belief": {name: other[name] for name in changed},
                    **context,
                    "observation": dict(observed),
                    "at": at,
                    "posterior": float(one[index]),
                    "other_posterior": float(two[index]),
                }
        return None

    def _beliefs(self) -> Iterator[tuple[Belief, dict[str, Value]]]:
        """Product beliefs with two values for each tied variable; the first ones where the factor shows its tie."""
        table = self.join.table
        pairs: dict[str, list[Value]] = {}
        others: dict[str, Value] = {}
        for variable in table.scope:
            witness = influence(table, variable)
            if witness is not None:
                others.update({name: value for name, value in witness.others.items() if name not in others})
                pairs.setdefault(variable.name.removesuffix(".next"), []).extend(witness.values)
        for trial in range(_TRIALS):
            belief: Belief = {}
            for name, variable in self.hidden.items():
                picked: list[Value] = list(dict.fromkeys(pairs.get(name, [])))[:2] if trial < _TRIALS // 3 else []
                while len(picked) < min(2, variable.size):
                    near = others.get(name, others.get(f"{name}.next")) if trial < _TRIALS // 3 else None
                    fresh = near if near is not None and near not in picked else self._any(variable.values)
                    if fresh not in picked:
                        picked.append(fresh)
                share = 0.5 if trial % 2 == 0 else float(self.rng.uniform(0.2, 0.8))
                belief[name] = (
                    dict(zip(picked, (share, 1 - share), strict=False)) if len(picked) > 1 else {picked[0]: 1.0}
                )
            yield belief, others if trial < _TRIALS // 3 else {}

    @cached_property
    def _running(self) -> Factor | None:
        """Over current states of the block: zero where the episode is over."""
        told = self.block.likelihood.get(GOES_ON.name)
        if told is None:
            return None
        return told.condition({GOES_ON.name: True}).renamed({v.name: v.now.name for v in told.scope})

    def _going_on(self, belief: Belief, context: Mapping[str, Any]) -> Belief | None:
        """The belief without values at which the episode could be over; ``None`` if it then has none left."""
        if self.structure.is_over(context["known"]):
            return None
        if self._running is None:
            return belief
        left, running = dict(belief), self._running.condition(context["known"])
        while True:
            states = itertools.product(*(left[name] for name in running.names))
            over = next(
                (state for state in states if not running.value(dict(zip(running.names, state, strict=True)))), ()
            )
            drop = [(name, value) for name, value in zip(running.names, over, strict=False) if len(left[name]) > 1]
            if not drop:
                return None if over or not (running.scope or running.value({})) else left
            name, value = drop[int(self.rng.integers(len(drop)))]
            left[name] = {other: 1.0 for other in left[name] if other != value}

    def _context(self, others: Mapping[str, Value]) -> dict[str, Any]:
        """An action and known values; those of the witness where it names them."""
        known = {name: others.get(name, self._any(self.model.variable(name).values)) for name in self.structure.known}
        action: dict[str, Value] = {}
        for variable in self.model.actions:
            allowed = [value for value in variable.values if self.model.is_legal({variable.name: value}, known)]
            near = others.get(variable.name)
            action[variable.name] = near if near in allowed else self._any(allowed)
        return {"action": action, "known": known}

    def _any(self, values: Sequence[Value]) -> Value:
        return values[int(self.rng.integers(len(values)))]

    def _given(self, context: Mapping[str, Any]) -> dict[str, Value]:
        given = {**context["action"], **context["known"]}
        for name, factor in self.structure.functions.items():
            line = factor.condition(given).dense()
            if len(line.scope) == 1:
                given[f"{name}.next"] = line.scope[0].values[int(line.array.argmax())]
        return given

    def _predicted(self, belief: Belief, context: Mapping[str, Any]) -> Factor:
        """Joint table over current and next hidden variables (current ones are needed by known ones that are seen)."""
        given = self._given(context)
        table: Factor = constant(1.0)
        for name, masses in belief.items():
            variable = self.hidden[name]
            rows = [[variable.index(value)] for value in masses]
            table = table.product(SparseFactor([variable], rows, list(masses.values())))
        left = {name: factor.condition(given) for name, factor in self.block.transition.items()}
        while left:
            name = next(
                n
                for n, f in left.items()
                if not any(v.is_next and v.name[:-5] in left for v in f.scope if v.name != f"{n}.next")
            )
            table = table.product(left.pop(name))
        return table

    def _observation(
        self, predicted: Factor, context: Mapping[str, Any], others: Mapping[str, Value]
    ) -> dict[str, Value]:
        """Draw a value for everything that is seen of the block; the witness' own where it has one."""
        given, observed = self._given(context), self._read_back(context)
        for name, factor in self.block.likelihood.items():
            child = name if name in self.seen else f"{name}.next"
            table = factor.condition({n: v for n, v in {**given, **observed}.items() if n != child})
            line = contract([predicted, *self._shown(observed, given), table], [table.variable(child)]).array_over(
                [table.variable(child)]
            )
            if child in others and line[table.variable(child).index(others[child])] > 0:
                observed[child] = others[child]
            elif line.sum() > 0:
                observed[child] = table.variable(child).values[int(self.rng.choice(len(line), p=line / line.sum()))]
        return observed

    def _read_back(self, context: Mapping[str, Any]) -> dict[str, Value]:
        """Possible next values of the known variables that are left to chance, but not to hidden variables."""
        given, read = self._given(context), {}
        for name in self.structure.known:
            if name not in self.structure.functions and f"{name}.next" in self.structure.laws:
                line = self.structure.laws[f"{name}.next"].condition(given).dense()
                read[f"{name}.next"] = line.scope[0].values[int(line.array.argmax())]
        return read

    def _shown(self, observed: Mapping[str, Value], given: Mapping[str, Value]) -> list[Factor]:
        names = {**given, **observed}
        keys = {name: name if name in self.seen else f"{name}.next" for name in self.block.likelihood}
        return [self.block.likelihood[n].condition({**names}) for n, child in keys.items() if child in observed]

    def _posterior(self, predicted: Factor, context: Mapping[str, Any], observed: Mapping[str, Value]) -> Factor | None:
        after = [variable.next for variable in self.block.variables]
        table = contract([predicted, *self._shown(observed, self._given(context))], after).sparse()
        total = float(table.numbers.sum())
        if not total > 0:
            return None
        return table.product(constant(1 / total)).renamed({v.next.name: v.name for v in self.block.variables})

    def _expected(self, belief: Belief, context: Mapping[str, Any]) -> float:
        """Expected value of the tying reward for one belief."""
        given = self._given(context)
        factors = [self._predicted(belief, context), self.join.table.condition(given)]
        laws = dict(self.structure.laws)
        for name, factor in self.block.likelihood.items():
            laws[name if name in self.seen else f"{name}.next"] = factor
        waiting, done = list(factors[1].names), set(given)
        while waiting:
            name = waiting.pop()
            if name in laws and name not in done:
                factors.append(laws[name].condition(given))
                waiting += factors[-1].names
            done.add(name)
        return float(contract(factors, []).dense().array)


def _marginal(table: Factor, kept: list[Variable]) -> np.ndarray:
    rest = [variable for variable in table.scope if variable not in kept]
    return (table.marginalise(*rest) if rest else table).array_over(kept)
