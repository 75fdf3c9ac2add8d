"""A belief that is a product over blocks (eq:bel), kept stack by stack.

``predict`` and ``condition`` are pure: they return a new belief. Cost of a step: the stored entries of the operators,
once a stack, times its members; memory: one number for each state and member.

Where the model has terminal states, whoever acts is told of the end. So every belief is given that the episode goes on,
block by block, but for a predicted one, which still holds the mass of what the step may end in.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs.findings import Finding, findings_of
from factored_pomdp.beliefs.plan import Plan, StackPlan
from factored_pomdp.beliefs.roster import Members, Names, Roster
from factored_pomdp.errors import ImpossibleObservation, did_you_mean
from factored_pomdp.factors import DenseFactor, DeterministicFactor
from factored_pomdp.structure import GOES_ON
from factored_pomdp.variables import Value

__all__ = ["ProductBelief", "Restart"]

Restart = Callable[[tuple[str, ...], "Float[np.ndarray, '...']", Mapping[str, Value], Mapping[str, Value]], Any]
"""``restart(block, predicted, observation, known)`` gives a contradicted block its new belief, of the block's shape."""

_MOST_MOVES = 10_000
_ROUNDING = 1e-15


@dataclass(frozen=True, eq=False)
class ProductBelief:
    """``b(hidden) = ∏ b_k(block k)`` beside known values.

    Attributes
    ----------
    known : dict
        Values of the known variables; ``None`` where one could not be read.
    arrays : tuple of (states, members) float
        One for each stack; columns sum to one.
    roster : Roster
        Whose columns those are.
    approximations : tuple of str
        Why this is not the exact posterior; empty while it is.
    """

    plan: Plan
    known: Mapping[str, Value]
    arrays: tuple[Float[np.ndarray, "_states _members"], ...]
    roster: Roster
    approximations: tuple[str, ...] = ()
    project: bool = False
    action: Mapping[str, Value] | None = None
    before: Mapping[str, Value] | None = None
    prior: ProductBelief | None = field(default=None, repr=False)
    _predictions: dict[Any, Any] = field(default_factory=dict, repr=False)

    @property
    def exact(self) -> bool:
        """Whether this is the exact Bayesian posterior of the model."""
        return not self.approximations

    @property
    def members(self) -> tuple[tuple[Names, ...], ...]:
        """For each stack and member, the pattern's names to the member's own."""
        return self.roster.names

    @property
    def blocks(self) -> tuple[tuple[str, ...], ...]:
        """Names of the hidden variables, block by block."""
        return self.roster.blocks

    def _with(self, **changes: Any) -> ProductBelief:
        """The belief with some fields changed, and no predictions made from it yet."""
        other = object.__new__(ProductBelief)
        other.__dict__.update(self.__dict__, _predictions={}, **changes)
        return other

    def predict(self, action: Any) -> ProductBelief:
        """The belief after an action and before its observation (the sum in eq:belup2).

        Whether the action is legal is for whoever chooses to ask; here it has been done.
        """
        chosen = self.plan.structure.model.action(action)
        start = self.running()
        after = start.next_known(chosen)
        arrays = tuple(start.predicted(number, chosen, after) for number in range(len(start.arrays)))
        prior = start._with(prior=None) if self.plan.early else None
        return start._with(known=after, arrays=arrays, action=chosen, before=start.known, prior=prior)

    def running(self) -> ProductBelief:
        """The belief given that the episode goes on; this very one where it holds no mass in terminal states.

        Raises
        ------
        ImpossibleObservation
            Where all the mass of a block, or what is known, says that the episode is over.
        """
        self._refuse_the_end(self.known)
        told = self._told_to_go_on
        if not told:
            return self
        given = {f"{name}.next": value for name, value in self.known.items()}
        arrays = []
        for members, array in zip(self.roster.stacks, self.arrays, strict=True):
            findings = findings_of(members, told, {}, {}, given)
            arrays.append(self._conditioned(members, array, findings, (told, self.known), None, []))
        if all(np.allclose(*pair, rtol=0.0, atol=_ROUNDING) for pair in zip(arrays, self.arrays, strict=True)):
            return self
        return self._with(arrays=tuple(arrays))

    @property
    def _told_to_go_on(self) -> dict[str, Value]:
        """What is observed of hidden variables where an episode goes on."""
        structure = self.plan.structure
        return {} if structure.model.running is None or structure.running is not None else {GOES_ON.name: True}

    def _refuse_the_end(self, known: Mapping[str, Value]) -> None:
        """Refuse to go on where known values alone say that the episode is over."""
        if self.plan.structure.is_over(known):
            raise ImpossibleObservation(known, dict(self.action or {}), {**known, GOES_ON.name: True})

    def next_known(self, action: Mapping[str, Value]) -> dict[str, Value]:
        """Values of the known variables after an action, as planned; ``None`` where a parent is not known."""
        key = (*self.known.items(), *action.items())
        if key not in self.plan.moves:
            if len(self.plan.moves) >= _MOST_MOVES:
                self.plan.moves.clear()
            self.plan.moves[key] = self._next_known(action)
        return dict(self.plan.moves[key])

    def _next_known(self, action: Mapping[str, Value]) -> dict[str, Value]:
        values: dict[str, Value] = {}
        given: dict[str, Value] = {**self.known, **action}
        functions = self.plan.structure.functions
        waiting = [name for name in self.plan.structure.known if name in functions]
        while waiting:
            for name in list(waiting):
                parents = [v.name for v in functions[name].scope if v.name != f"{name}.next"]
                if any(parent.removesuffix(".next") in waiting for parent in parents if parent.endswith(".next")):
                    continue
                at = {parent: given.get(parent) for parent in parents}
                values[name] = None if None in at.values() else _result(functions[name], f"{name}.next", at)
                given[f"{name}.next"] = values[name]
                waiting.remove(name)
        return {name: values.get(name) for name in self.plan.structure.known}

    def predicted(
        self, stack: int, action: Mapping[str, Value], after: Mapping[str, Value]
    ) -> Float[np.ndarray, "states members"]:
        """Predicted array of one stack; kept, so that choosing and then predicting cost one prediction."""
        plan, array, members = self.plan.stacks[stack], self.arrays[stack], self.members[stack]
        context = plan.prediction.context
        given = self._given(action, after) if context else {}
        if not any(variable.name in plan.stack.own for variable in context):
            key = (stack, tuple(given[variable.name] for variable in context))
            if key not in self._predictions:
                self._predictions[key] = plan.prediction.apply(array, {v.name: given[v.name] for v in context})
            return self._predictions[key]
        groups: dict[tuple[Value, ...], list[int]] = {}
        for column, names in enumerate(members):
            groups.setdefault(tuple(given[names.get(v.name, v.name)] for v in context), []).append(column)
        result = np.empty_like(array)
        for values, columns in groups.items():
            at = dict(zip((variable.name for variable in context), values, strict=True))
            result[:, columns] = plan.prediction.apply(np.ascontiguousarray(array[:, columns]), at)
        return result

    def _given(self, action: Mapping[str, Value], after: Mapping[str, Value]) -> dict[str, Value]:
        """Known values of both slices, and the action."""
        return {**self.known, **action, **{f"{name}.next": value for name, value in after.items()}}

    def condition(
        self, observation: Any = None, known: Mapping[str, Value] | None = None, restart: Restart | None = None
    ) -> ProductBelief:
        """The posterior (eq:belup2) given what was observed, the known values that were read back, and that it goes on.

        Parameters
        ----------
        observation : mapping or value
            Observation variables that are left out were not looked at.
        known : mapping, optional
            Read-back values; they replace the planned ones. ``None`` for one that could not be read: it then says
            nothing (possible where it is a cause of a noisy-or). A hidden variable's value is evidence about its block.
        restart : callable, optional
            Gives a new belief to a block for which the observation is impossible.

        Raises
        ------
        ImpossibleObservation
            Where a block calls the observation impossible and there is no ``restart``.
        """
        model = self.plan.structure.model
        if observation is None:
            observation = {}
        elif not isinstance(observation, Mapping):
            observation = model.observed(observation)
        known = known or {}
        places = self.roster.places
        hidden = {name: value for name, value in known.items() if name in places and value is not None}
        actual = self._actual({n: v for n, v in known.items() if n not in places}, observation)
        self._refuse_unknown(observation)
        self._refuse_the_end(actual)
        reasons = list(self.approximations)
        arrays = []
        before = self.before if self.before is not None else self.known
        given = {**before, **(self.action or {}), **{f"{name}.next": value for name, value in actual.items()}}
        self._refuse_impossible(observation, given)
        newly = {name: value for name, value in actual.items() if self.known.get(name) is None}
        told, looked = (observation, actual), {**observation, **self._told_to_go_on}
        for number, (members, array) in enumerate(zip(self.roster.stacks, self.arrays, strict=True)):
            early = findings_of(members, {}, newly, {}, given, early=True) if newly else []
            if early:
                prior = self._earlier()
                weighed = self._conditioned(members, prior.arrays[number], early, told, restart, reasons)
                arrays_then = (*prior.arrays[:number], weighed, *prior.arrays[number + 1 :])
                prior = prior._with(arrays=arrays_then)
                array = prior.predicted(number, self.action or {}, prior.next_known(self.action or {}))
            findings = findings_of(members, looked, newly, hidden, given)
            arrays.append(self._conditioned(members, array, findings, told, restart, reasons))
        after = self._with(known=actual, arrays=tuple(arrays), approximations=tuple(dict.fromkeys(reasons)), prior=None)
        return after._projected() if self.project else after

    def _earlier(self) -> ProductBelief:
        """The belief before the step, about which some known variables tell."""
        if self.prior is None:
            raise ValueError(
                "known variables that tell of hidden ones are read in the first condition() after predict()"
            )
        return self.prior

    def _conditioned(
        self,
        members: Members,
        array: np.ndarray,
        findings: Iterable[Finding],
        told: tuple[Mapping[str, Value], Mapping[str, Value]],
        restart: Restart | None,
        reasons: list[str],
    ) -> np.ndarray:
        from factored_pomdp.beliefs.kernels import reweigh

        plan, predicted = members.plan, array
        for finding in findings:
            result, impossible = reweigh(array, finding.context, finding.likelihood)
            for column in impossible:
                block = tuple(members.names[column][variable.name] for variable in plan.variables)
                if restart is None:
                    raise ImpossibleObservation(block, dict(self.action or {}), finding.of(int(column)))
                fresh = np.asarray(restart(block, predicted[:, column].reshape(plan.shape), *told), float)
                if not fresh.sum() > 0:
                    raise ValueError(f"restart of block [{', '.join(block)}] gave a belief without mass")
                result[:, column] = fresh.ravel() / fresh.sum()
                reasons.append(f"restarted: {', '.join(block)}")
            array = result
        return array

    def _actual(self, known: Mapping[str, Value], observation: Mapping[str, Value]) -> dict[str, Value]:
        structure = self.plan.structure
        actual = dict(self.known)
        for name, value in known.items():
            if name not in actual:
                names = [*actual, *(n for block in self.blocks for n in block)]
                raise ValueError(f"no state variable {name!r}{did_you_mean(name, names)}")
            if value is not None:
                structure.model.variable(name).index(value)
            actual[name] = value
        for name, seen in structure.shown_by.items():
            if name not in known and observation.get(seen) is not None:
                actual[name] = self._shown(name, seen, observation[seen], actual)
        return actual

    def _shown(self, name: str, seen: str, value: Value, actual: Mapping[str, Value]) -> Value | None:
        """The value of a known variable that an observation shows, everything else that it reads being told."""
        model = self.plan.structure.model
        after, factor = model.variable(f"{name}.next"), model.observation[seen]
        others = {v.name: actual[v.now.name] for v in factor.scope if v != after and v.now.name in actual}
        if None in others.values():
            return None
        line = factor.condition({**(self.action or {}), **others, seen: value})
        idle = [variable for variable in line.scope if variable != after]
        possible = (line.marginalise(*idle) if idle else line).array_over([after])
        if not possible.max() > 0:
            raise ImpossibleObservation([name], dict(self.action or {}), {seen: value})
        return after.values[int(possible.argmax())]

    def _refuse_unknown(self, observation: Mapping[str, Value]) -> None:
        names = self.roster.observations
        for name in observation:
            if name not in names:
                raise ValueError(f"no observation variable {name!r}{did_you_mean(name, names)}")

    def _refuse_impossible(self, observation: Mapping[str, Value], given: Mapping[str, Value | None]) -> None:
        """Refuse what known values and the action alone say cannot be observed."""
        for name in self.plan.unhidden & observation.keys():
            law = self.plan.structure.laws[name]
            parents = {parent: given[parent] for parent in law.names if parent != name}
            if None in parents.values() or observation[name] is None:
                continue
            if not law.value({**parents, name: observation[name]}) > 0:
                told = {parent.removesuffix(".next") for parent in parents} & self.known.keys()
                raise ImpossibleObservation(sorted(told), dict(self.action or {}), {name: observation[name]})

    def _projected(self) -> ProductBelief:
        """Replace every block by the product of its things' marginals (Boyen and Koller, UAI 1998)."""
        thing_of = {name: number for number, thing in enumerate(self.plan.structure.things) for name in thing}
        arrays, reasons = [], list(self.approximations)
        for plan, array in zip(self.plan.stacks, self.arrays, strict=True):
            things = [thing_of[variable.name] for variable in plan.variables]
            product = np.ones((*plan.shape, array.shape[1]))
            for thing in set(things):
                gone = tuple(axis for axis, other in enumerate(things) if other != thing)
                product = product * array.reshape(*plan.shape, -1).sum(axis=gone, keepdims=True)
            arrays.append(product.reshape(array.shape))
            if len(set(things)) > 1:
                reasons.append("tied things kept apart (Boyen–Koller projection)")
        return self._with(arrays=tuple(arrays), approximations=tuple(dict.fromkeys(reasons)))

    def marginal(self, name: str) -> Float[np.ndarray, " values"]:
        """Probabilities of one hidden variable's values."""
        plan, array, column, names = self._find(name)
        shape = plan.shape
        axis = next(a for a, variable in enumerate(plan.variables) if names[variable.name] == name)
        return np.asarray(array[:, column].reshape(shape).sum(axis=tuple(a for a in range(len(shape)) if a != axis)))

    def block(self, name: str) -> DenseFactor:
        """Joint probabilities of the block that holds a hidden variable."""
        plan, array, column, names = self._find(name)
        scope = [variable.renamed(names[variable.name]) for variable in plan.variables]
        return DenseFactor(scope, array[:, column].reshape(plan.shape))

    def with_block(self, names: Mapping[str, str], distribution: Any) -> ProductBelief:
        """One more block, shaped like one that is there, or that the model has.

        Parameters
        ----------
        names : mapping
            Names of an existing block's variables (states, and observations and actions of its own) to new names.
        distribution : array_like
            Not negative, of the block's variables' sizes; normalised here.

        Raises
        ------
        ValueError
            For names that are taken or unknown, and for numbers that are no distribution.
        """
        stack, existing = self.roster.template(names)
        fresh = self.roster.renamed(stack, existing, names)
        plan = self.plan.stacks[stack]
        column = _distribution(distribution, plan.shape, [fresh[variable.name] for variable in plan.variables])
        arrays, members = list(self.arrays), list(self.members)
        arrays[stack] = np.ascontiguousarray(np.concatenate([arrays[stack], column], axis=1))
        members[stack] = (*members[stack], fresh)
        return self._with(arrays=tuple(arrays), roster=Roster(self.plan, tuple(members)), prior=None)

    def without_block(self, name: str) -> ProductBelief:
        """The belief without the block that holds a hidden variable."""
        plan, array, column, _ = self._find(name)
        stack = self.plan.stacks.index(plan)
        arrays, members = list(self.arrays), list(self.members)
        arrays[stack] = np.ascontiguousarray(np.delete(array, column, axis=1))
        members[stack] = members[stack][:column] + members[stack][column + 1 :]
        return self._with(arrays=tuple(arrays), roster=Roster(self.plan, tuple(members)), prior=None)

    def with_arrays(self, arrays: Iterable[np.ndarray], known: Mapping[str, Value] | None = None) -> ProductBelief:
        """The same blocks with other probabilities, (states, members) a stack, and perhaps other known values."""
        fresh = tuple(np.ascontiguousarray(array, dtype=float) for array in arrays)
        return self._with(arrays=fresh, known=dict(known if known is not None else self.known))

    def _find(self, name: str) -> tuple[StackPlan, np.ndarray, int, Names]:
        if name not in self.roster.places:
            raise ValueError(f"no hidden variable {name!r}{did_you_mean(name, self.roster.places)}")
        stack, column = self.roster.places[name]
        return self.plan.stacks[stack], self.arrays[stack], column, self.members[stack][column]


def _distribution(given: Any, shape: tuple[int, ...], names: Iterable[str]) -> np.ndarray:
    """(states, 1), with sum one."""
    numbers, size, what = np.asarray(given, dtype=float), math.prod(shape), ", ".join(names)
    if numbers.size != size or numbers.shape not in (shape, (size,), (size, 1)):
        raise ValueError(f"distribution of [{what}]: shape {numbers.shape}; expected {shape}")
    if not (np.isfinite(numbers).all() and (numbers >= 0).all() and numbers.sum() > 0):
        raise ValueError(f"distribution of [{what}]: expected numbers from 0 on, with some mass among them")
    return np.asarray(numbers.reshape(-1, 1) / numbers.sum())


def _result(function: Any, child: str, at: Mapping[str, Value]) -> Value:
    if isinstance(function, DeterministicFactor) and function.child.name == child:
        return function.result(at)
    line = function.condition(at).dense()
    return line.scope[0].values[int(line.array.argmax())]
