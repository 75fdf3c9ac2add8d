"""A decision problem under uncertainty, as named variables and factors."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

from factored_pomdp.errors import Fault, ModelError, did_you_mean
from factored_pomdp.factors import DenseFactor, Factor
from factored_pomdp.specification import Specification, resolve, table
from factored_pomdp.validation import checked_distribution, checked_reward, is_certain
from factored_pomdp.variables import Value, Variable, count

__all__ = ["FactoredPOMDP"]

_Allowed = Callable[[Variable], Mapping[str, Variable]]
"""Which variables may stand in the distribution of a child."""


class FactoredPOMDP:
    """States, actions, observations, one conditional distribution for each, a sum of rewards, a belief, a discount.

    The model is made in full or not at all: `ModelError` lists every fault. Distributions are given as a function of
    named values (its parameters name the parents; it returns ``{value: probability}``, or one value where the outcome
    is certain), as a nested mapping or an array through `table`, or as a `Factor`.

    Parameters
    ----------
    states, actions, observations : sequences of Variable
    transition : mapping
        For each state variable ``x`` the distribution of ``x.next`` given states, actions and other ``y.next``.
    observation : mapping
        For each observation variable its distribution given next states and actions.
    reward : mapping of name to specification, or one specification
        A sum of functions of any of state, action, next state, observation.
    initial : mapping
        For each state variable its distribution, given other state variables where they are tied; a bare value is
        certain.
    discount : float
        In [0, 1].
    known : iterable of str
        State variables that are read back after every step, besides those that `decompose` finds to be known.
    groups : iterable of iterables of str
        State variables that make up one thing (a target's place and heading). They are never told apart, and no tie
        within a group is reported.
    legal : mapping of action name to function
        For an action variable, a function of (known state variables, that action) which says whether it may be chosen.
    terminal : specification, optional
        A function of state variables, not zero where an episode ends on entering the state. With one state variable, a
        mapping of its values will do; those left out are not terminal. Whoever acts is told of the end: an action is
        taken only while the episode goes on, and every belief is given that it does.

    Attributes
    ----------
    notes : tuple of str
        What was mended (distributions renormalised within 1e-5).
    derived : dict
        What was worked out of the model, kept with it so that it is worked out once.
    """

    def __init__(
        self,
        *,
        states: Sequence[Variable],
        actions: Sequence[Variable],
        observations: Sequence[Variable],
        transition: Mapping[str, Specification],
        observation: Mapping[str, Specification],
        reward: Mapping[str, Specification] | Specification,
        initial: Mapping[str, Any],
        discount: float = 1.0,
        known: Iterable[str] = (),
        groups: Iterable[Iterable[str]] = (),
        legal: Mapping[str, Callable[..., Any] | Specification] | None = None,
        terminal: Specification | None = None,
        name: str = "model",
    ) -> None:
        self.name, self.discount = name, discount
        given = tuple(states), tuple(actions), tuple(observations)
        self.states, self.actions, self.observations = (tuple(v for v in vs if _is_usable(v)) for vs in given)
        self.declared_known = frozenset(known)
        self.groups = tuple(tuple(group) for group in groups)
        faults = self._name_faults(*given)
        notes: list[str] = []
        state, action = _by_name(self.states), _by_name(self.actions)
        after = _by_name(variable.next for variable in self.states)
        seen = _by_name(self.observations)
        everything = state | action | after | seen
        before, parents = state | action | after, after | action
        build = _Builder(faults, notes)
        self.initial = build.distributions("initial", initial, state, lambda child: state)
        self.transition = build.distributions(
            "transition", transition, {x: v.next for x, v in state.items()}, lambda child: before
        )
        self.observation = build.distributions(
            "observation", observation, seen, lambda child: ChainMap({child.name: child}, parents)
        )
        self.reward = build.rewards(reward, everything)
        self.legal = build.legal(legal or {}, action, state)
        self.terminal = build.terminal(terminal, state)
        build.acyclic("initial", self.initial)
        build.acyclic("transition", self.transition)
        build.known(self.declared_known, self.initial)
        if not (isinstance(discount, int | float) and 0 <= discount <= 1):
            faults.append(Fault("discount", repr(discount), "a number in [0, 1]"))
        if faults:
            raise ModelError(faults)
        self.notes = tuple(notes)
        self.derived: dict[str, Any] = {}

    @cached_property
    def variables(self) -> dict[str, Variable]:
        """Every variable by name, those of the next slice included."""
        return _by_name([*self.states, *(v.next for v in self.states), *self.actions, *self.observations])

    def variable(self, name: str) -> Variable:
        """The variable of that name; ``ValueError`` with a suggestion if there is none."""
        if name not in self.variables:
            raise ValueError(f"no variable {name!r} in {self.name}{did_you_mean(name, self.variables)}")
        return self.variables[name]

    @property
    def joint_states(self) -> int:
        return count(self.states)

    @property
    def joint_actions(self) -> int:
        return count(self.actions)

    @property
    def joint_observations(self) -> int:
        return count(self.observations)

    def action(self, action: Any) -> dict[str, Value]:
        """A full joint action from a mapping, or from a bare value where there is one action variable."""
        return _assignment(action, self._actions_by_name, "action", complete=True)

    def observed(self, observation: Any) -> dict[str, Value]:
        """Values of observation variables; those left out were not observed."""
        return _assignment(observation, self._observations_by_name, "observation", complete=False)

    @cached_property
    def _actions_by_name(self) -> dict[str, Variable]:
        return _by_name(self.actions)

    @cached_property
    def _observations_by_name(self) -> dict[str, Variable]:
        return _by_name(self.observations)

    def is_terminal(self, state: Mapping[str, Value]) -> bool:
        """Whether an episode ends on entering this state."""
        return self.terminal is not None and bool(self.terminal.value(state))

    @cached_property
    def running(self) -> Factor | None:
        """One where an episode goes on, zero in terminal states; ``None`` where there are none."""
        if self.terminal is None:
            return None
        ends = self.terminal.dense()
        return DenseFactor(ends.scope, ends.array == 0)

    def is_legal(self, action: Mapping[str, Value], known: Mapping[str, Value]) -> bool:
        """Whether every action variable's value may be chosen in a known state (unknown parts forbid nothing)."""
        for factor in self.legal.values():
            given = {**known, **action}
            if all(given.get(name) is not None for name in factor.names) and not factor.value(given):
                return False
        return True

    def _name_faults(
        self, given_states: Sequence[Any], given_actions: Sequence[Any], given_observations: Sequence[Any]
    ) -> list[Fault]:
        faults = []
        names: dict[str, str] = {}
        kinds = [("state", given_states), ("action", given_actions), ("observation", given_observations)]
        for kind, variables in kinds:
            for variable in variables:
                if not isinstance(variable, Variable):
                    faults.append(Fault(kind, repr(variable), "a Variable"))
                    continue
                if variable.name in names:
                    faults.append(
                        Fault(
                            f"variable {variable.name}",
                            f"the name of two: {names[variable.name]} and {kind}",
                            "a name used once",
                        )
                    )
                if variable.is_next:
                    faults.append(Fault(f"variable {variable.name}", "the ending '.next'", "a name without it"))
                names[variable.name] = kind
        if not given_states:
            faults.append(Fault("states", "none", "at least one variable"))
        if not given_actions:
            faults.append(Fault("actions", "none", "at least one variable"))
        states = {variable.name for variable in self.states}
        for what, listed in (("known", self.declared_known), *((f"group {g}", g) for g in self.groups)):
            for name in listed:
                if name not in states:
                    faults.append(
                        Fault(what, f"the unknown state {name!r}", f"a state variable{did_you_mean(name, states)}")
                    )
        return faults

    def __repr__(self) -> str:
        return (
            f"FactoredPOMDP({self.name!r}: {len(self.states)} state variables, {self.joint_states:,} joint states, "
            f"{self.joint_actions:,} actions, {self.joint_observations:,} observations)"
        )


class _Builder:
    """Turns specifications into checked factors and gathers faults and notes."""

    def __init__(self, faults: list[Fault], notes: list[str]) -> None:
        self.faults, self.notes = faults, notes
        self._tables: dict[tuple[int, ...], tuple[Factor, Factor]] = {}

    def distributions(
        self, kind: str, given: Mapping[str, Any], children: Mapping[str, Variable], allowed: _Allowed
    ) -> dict[str, Factor]:
        factors = {}
        for name in given:
            if name not in children:
                expected = f"one of the model's variables{did_you_mean(name, children)}"
                self.faults.append(Fault(f"{kind}[{name!r}]", "an unknown variable", expected))
        for name, child in children.items():
            where = f"{kind} of {child.name}"
            if name not in given:
                self.faults.append(Fault(where, "no distribution", "one for every variable"))
                continue
            factor = resolve(given[name], child, allowed(child), where, self.faults)
            if factor is not None:
                factors[name] = self._checked(factor, child, where)
        return factors

    def _checked(self, factor: Factor, child: Variable, where: str) -> Factor:
        """Check a distribution once for all the variables whose tables it is."""
        key = (*factor.storage, factor.scope.index(child), *(id(variable.values) for variable in factor.scope))
        if key not in self._tables:
            faults = len(self.faults)
            checked = checked_distribution(factor, child, where, self.faults, self.notes)
            if len(self.faults) > faults:
                return factor
            self._tables[key] = factor, checked
        original, checked = self._tables[key]
        return checked.renamed(dict(zip(original.names, factor.names, strict=True)))

    def rewards(self, given: Any, variables: Mapping[str, Variable]) -> dict[str, Factor]:
        named = given if isinstance(given, Mapping) else {"reward": given}
        factors = {}
        for name, specification in named.items():
            where = f"reward {name}"
            factor = resolve(specification, None, variables, where, self.faults)
            if factor is not None:
                factors[str(name)] = checked_reward(factor, where, self.faults)
        return factors

    def legal(
        self, given: Mapping[str, Any], actions: dict[str, Variable], states: dict[str, Variable]
    ) -> dict[str, Factor]:
        factors = {}
        for name, specification in given.items():
            if name not in actions:
                self.faults.append(
                    Fault(f"legal[{name!r}]", "an unknown action", f"an action{did_you_mean(name, actions)}")
                )
                continue
            factor = resolve(specification, None, states | {name: actions[name]}, f"legal {name}", self.faults)
            if factor is None:
                continue
            table = factor.dense()
            if actions[name] not in table.scope:
                self.faults.append(
                    Fault(f"legal {name}", f"a function that does not read {name}", f"{name} in its scope")
                )
            elif not (table.array.max(axis=table.scope.index(actions[name])) > 0).all():
                self.faults.append(Fault(f"legal {name}", "a state without any legal action", "at least one"))
            factors[name] = factor
        return factors

    def terminal(self, given: Specification | None, states: dict[str, Variable]) -> Factor | None:
        if given is None:
            return None
        if isinstance(given, Mapping) and len(states) == 1:
            (only,) = states.values()
            given = table(only, values=dict.fromkeys(only.values, 0.0) | dict(given))
        factor = resolve(given, None, states, "terminal", self.faults)
        return None if factor is None else checked_reward(factor, "terminal", self.faults)

    def known(self, declared: Iterable[str], initial: Mapping[str, Factor]) -> None:
        """Note the variables that are declared known, but whose start is not."""
        uncertain = {name for name, factor in initial.items() if not is_certain(factor, name)}
        while more := {n for n, f in initial.items() if n not in uncertain and uncertain & set(f.names)}:
            uncertain |= more
        for name in sorted(uncertain & set(declared)):
            self.faults.append(
                Fault(f"known {name}", "an uncertain start", "a certain initial value, as nothing is read before it")
            )

    def acyclic(self, kind: str, factors: Mapping[str, Factor]) -> None:
        """Note the distributions that depend on each other in a circle (within one slice)."""
        twin = {f"{name}.next" if kind == "transition" else name: name for name in factors}
        left = {n: {twin[v.name] for v in factor.scope if v.name in twin} - {n} for n, factor in factors.items()}
        while ready := [name for name, needs in left.items() if not needs & left.keys()]:
            for name in ready:
                del left[name]
        if left:
            self.faults.append(Fault(kind, f"a circle through {', '.join(left)}", "distributions in some order"))


def _is_usable(variable: Any) -> bool:
    return isinstance(variable, Variable) and not variable.is_next


def _assignment(given: Any, variables: Mapping[str, Variable], what: str, *, complete: bool) -> dict[str, Value]:
    """Checked values by name; a bare value where there is one variable."""
    if not isinstance(given, Mapping):
        if len(variables) != 1:
            raise ValueError(f"{what} {given!r}: expected a mapping of {', '.join(variables)}")
        given = dict.fromkeys(variables, given)
    for name, value in given.items():
        if name not in variables:
            raise ValueError(f"no {what} variable {name!r}{did_you_mean(name, variables)}")
        variables[name].index(value)
    missing = [name for name in variables if name not in given]
    if complete and missing:
        raise ValueError(f"{what}: no value for {', '.join(missing)}")
    return dict(given)


def _by_name(variables: Iterable[Variable]) -> dict[str, Variable]:
    return {variable.name: variable for variable in variables}
