"""One-step choice on a model that decomposes: linear in the blocks, and the same action as the exponential solver.

V(B, A) is a sum over blocks (eq:policy3). Rewards are linear in the belief, so the expectation over observations falls
away block by block (tower property): each reward term is contracted with its block's predicted marginal into a local
function of actions, equal blocks at once; then a joint action is chosen (`solvers.maximise`).
Cost of a decision: one prediction of the stacked belief, plus a choice that does not depend on the number of blocks.
When not to use it: where looking further ahead than one step pays.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from factored_pomdp.beliefs import ProductBelief, initial_belief
from factored_pomdp.beliefs.plan import StackPlan, plan_of
from factored_pomdp.contraction import contract
from factored_pomdp.factors import DenseFactor, ExpectedNoisyOr, Factor, NoisyOr, constant
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.structure import structure_of
from factored_pomdp.variables import Value, Variable, count
from solvers.action_values import Valued, summed_values
from solvers.base import Ability, Decision
from solvers.maximise import maximise

__all__ = ["DecomposedMyopic"]

_MOST_TEMPLATES = 1000
_MOST_STATES = 20_000_000


class DecomposedMyopic:
    """Maximises the expected reward of the next step over a `ProductBelief`, given that the episode goes on.

    Parameters
    ----------
    model : FactoredPOMDP
    """

    name = "myopic"
    summary = "one step ahead, block by block"

    def __init__(self, model: FactoredPOMDP) -> None:
        ability = self.can_solve(model)
        if not ability:
            raise ValueError(f"{ability.because}; {ability.estimate}")
        self.model = model
        self.plan = plan_of(model)
        factors = [*model.transition.values(), *model.observation.values(), *model.reward.values()]
        self._read = {variable.name for factor in factors for variable in factor.scope} & set(self.plan.structure.known)
        self._terms = [
            _Term(number, position, reward, _are_alike(plan, reward), self._reweighed(plan, reward))
            for number, plan in enumerate(self.plan.stacks)
            for position, (_, reward) in enumerate(plan.stack.pattern.rewards)
        ]
        self._templates: dict[tuple[object, ...], ExpectedNoisyOr] = {}

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes, unless a block is too large (a model that does not fall apart is one), or what is legal is hidden."""
        structure = structure_of(model)
        sizes = [count(block.variables) for block in structure.blocks]
        largest, states = max(sizes, default=1), sum(sizes)
        because = f"{len(sizes)} block(s), the largest with {largest:,} states"
        if largest > _MOST_STATES:
            return Ability(False, f"{because}; more than {_MOST_STATES:,}", f"{8 * largest:,} bytes a belief")
        hidden = {name for block in structure.blocks for name in block.names}
        for name, factor in model.legal.items():
            if read := sorted(hidden & set(factor.names)):
                return Ability(False, f"legal values of {name} depend on the hidden {', '.join(read)}", "none")
        return Ability(
            True, because, f"{8 * states:,} bytes a belief; {model.joint_actions:,} joint actions to choose from"
        )

    def start(self) -> ProductBelief:
        """The model's initial belief, in the form that `decide` takes."""
        return initial_belief(self.model)

    def decide(self, belief: ProductBelief, prefer: Mapping[str, Value] | None = None) -> Decision:
        """The best action for the next step.

        Parameters
        ----------
        prefer : mapping, optional
            Action values to keep where that costs nothing.
        """
        return maximise(self.local_functions(belief), self.model.actions, self._legal(belief.known), prefer)

    def values(self, belief: ProductBelief) -> Valued:
        """Legal joint actions with V(B, A); beyond 100,000, the best and those that differ from it in one variable."""
        functions, legal = self.local_functions(belief), self._legal(belief.known)
        best = maximise(functions, self.model.actions, legal)
        return summed_values(functions, self.model.actions, legal, best.action)

    def _legal(self, known: Mapping[str, Value]) -> list[Factor]:
        """What may be chosen at known values, an action variable each."""
        rules = self.model.legal.values()
        return [factor.condition(_given(factor, known)) for factor in rules if _readable(factor, known)]

    def value(self, belief: ProductBelief, action: Any) -> float:
        """V(B, A): expected reward of the next step for one action (eq:policy3)."""
        chosen = self.model.action(action)
        return sum(float(f.condition(chosen).dense().array) for f in self.local_functions(belief))

    def local_functions(self, belief: ProductBelief) -> list[Factor]:
        """Functions of action variables whose sum is V(B, ·)."""
        belief = belief.running()
        known = belief.known
        functions = [
            self._of_actions(f.condition(_given(f, known)), known) for _, f in self.plan.structure.free_rewards
        ]
        for term in self._terms:
            members = belief.members[term.stack]
            if members and term.alike:
                functions.append(self._of_all(belief, term))
            elif members:
                functions += [
                    self._of_actions(self._local(belief, term, [column], names), known)
                    for column, names in enumerate(members)
                ]
        return functions

    def _of_all(self, belief: ProductBelief, term: _Term) -> Factor:
        """A stack's local function; a noisy-or's is made once for each set of known values, then only reweighed."""
        key = (term.stack, term.position, self._known_key(belief.known))
        if key in self._templates:
            predicted = belief.predicted(term.stack, {}, {})
            weights = _mass(predicted, belief.plan.stacks[term.stack].shape, term.axes)
            return self._templates[key].with_weights(weights.ravel())
        function = self._of_actions(self._local(belief, term, None, belief.members[term.stack][0]), belief.known)
        if isinstance(function, ExpectedNoisyOr) and term.axes:
            if len(self._templates) >= _MOST_TEMPLATES:
                self._templates.clear()
            self._templates[key] = function
        return function

    def _known_key(self, known: Mapping[str, Value]) -> tuple[Value, ...]:
        """What local functions depend on in the known values: those that some factor reads, and which are unread."""
        return tuple(value if name in self._read else value is None for name, value in known.items())

    def _reweighed(self, plan: StackPlan, reward: Factor) -> tuple[int, ...]:
        """Axes of the next variables whose mass is all that a local function takes from the belief, if that is so."""
        used = list(self._needed(reward, plan, {}).values())
        after = tuple(variable.next for variable in plan.variables)
        moved = any(variable in self.model.actions or variable.is_next for variable in plan.prediction.context)
        if moved or plan.stack.own - {seen.name for seen in plan.seen}:
            return ()
        if len(used) != 1 or not isinstance(used[0], NoisyOr) or not set(used[0].context) <= set(after):
            return ()
        return tuple(after.index(variable) for variable in used[0].context)

    def _local(self, belief: ProductBelief, term: _Term, columns: list[int] | None, names: Mapping[str, str]) -> Factor:
        """One reward term of some members of a stack, over actions and known variables' next values."""
        number, reward, plan = term.stack, term.reward, belief.plan.stacks[term.stack]
        rename = {old: new for old, new in names.items() if old in plan.stack.own}
        used = self._needed(reward, plan, rename)
        inner_now = [v for v in plan.variables if any(v in factor.scope for factor in (reward, *used.values()))]
        factors = [factor.condition(_given(factor, belief.known, rename)) for factor in (reward, *used.values())]
        if inner_now:
            array = belief.arrays[number] if columns is None else belief.arrays[number][:, columns]
            state = DenseFactor(plan.variables, _mass(array, plan.shape, range(len(plan.shape))))
            moves = [f.condition(_given(f, belief.known, rename)) for f in plan.stack.pattern.transition.values()]
            inner = {v for v in (*plan.variables, *(w.next for w in plan.variables))} | set(used)
            keep = [v for f in (*factors, *moves) for v in f.scope if v not in inner]
            return contract([state, *moves, *factors], keep).renamed(rename)
        hidden = [v.next for v in plan.variables if any(v.next in factor.scope for factor in factors)]
        weights = self._predicted(belief, number, columns, rename, hidden)
        expected = _expected(weights, factors, {*used, *(variable.next for variable in plan.variables)})
        return expected.renamed(rename)

    def _needed(self, reward: Factor, plan: StackPlan, rename: Mapping[str, str]) -> dict[Variable, Factor]:
        """Distributions of the observations and moved known variables that a reward reads, and of those they read."""
        seen = {seen.child: plan.stack.pattern.likelihood[seen.name] for seen in plan.seen}
        laws, back = self.plan.structure.laws, {own: old for old, own in rename.items()}
        needed: dict[Variable, Factor] = {}
        waiting = list(reward.scope)
        while waiting:
            variable = waiting.pop()
            law = laws.get(rename.get(variable.name, variable.name)) if not variable.is_next else None
            factor = seen.get(variable, law.renamed(back) if law is not None else None)
            if factor is not None and variable not in needed:
                needed[variable] = factor
                waiting += factor.scope
        return needed

    def _predicted(
        self,
        belief: ProductBelief,
        number: int,
        columns: list[int] | None,
        rename: Mapping[str, str],
        hidden: Sequence[Variable],
    ) -> Factor:
        """Predicted mass over some next variables, and over the actions that the prediction reads."""
        plan = belief.plan.stacks[number]
        free = self._actions_behind([rename.get(v.name, v.name) for v in plan.prediction.context])
        base = {v.name: v.values[0] for v in self.model.actions}
        after_all = [variable.next for variable in plan.variables]
        axes = [after_all.index(variable) for variable in hidden]
        tables = []
        for values in itertools.product(*(variable.values for variable in free)):
            action = {**base, **dict(zip((v.name for v in free), values, strict=True))}
            after = belief.next_known(action)
            if columns is None:
                predicted = belief.predicted(number, action, after)
            else:
                given = {**belief.known, **action, **{f"{name}.next": value for name, value in after.items()}}
                at = {v.name: given[rename.get(v.name, v.name)] for v in plan.prediction.context}
                predicted = plan.prediction.apply(np.ascontiguousarray(belief.arrays[number][:, columns]), at)
            tables.append(_mass(predicted, plan.shape, axes))
        back = {own: old for old, own in rename.items()}
        scope = [*(v.renamed(back.get(v.name, v.name)) for v in free), *hidden]
        return DenseFactor(scope, np.stack(tables).reshape([variable.size for variable in scope]))

    def _actions_behind(self, names: Sequence[str]) -> list[Variable]:
        """Action variables among some names, or that the known next values among them are functions of."""
        functions, waiting = self.plan.structure.functions, list(names)
        found: set[str] = set()
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                before = name.removesuffix(".next")
                waiting += functions[before].names if name != before and before in functions else ()
        return [variable for variable in self.model.actions if variable.name in found]

    def _of_actions(self, function: Factor, known: Mapping[str, Value]) -> Factor:
        """Replace known variables' next values, and observations of them alone, by what the actions make of them."""
        structure, model = self.plan.structure, self.model
        for variable in model.observations:
            if variable in function.scope:
                function = function.dense().product(structure.laws[variable.name]).marginalise(variable)
        chance = [name for name in structure.known if name not in structure.functions]
        for name in (*chance, *reversed(structure.functions)):
            after = model.variable(f"{name}.next")
            if after not in function.scope:
                continue
            moved = structure.laws[after.name]
            unread = [v.name for v in moved.scope if v.name in known and known[v.name] is None]
            if unread and not isinstance(function, ExpectedNoisyOr):
                raise ValueError(f"{', '.join(unread)} was not read back, and the reward depends on it through {name}")
            if unread:
                function = function.condition({after.name: None})
                continue
            moved = moved.condition(_given(moved, known))
            parents = [variable for variable in moved.scope if variable != after]
            if len(parents) == 1 and name in structure.functions:
                indexes = moved.array_over([parents[0], after]).argmax(axis=1)
                function = function.substituted(after, parents[0], indexes)
            elif not parents and name in structure.functions:
                function = function.condition({after.name: after.values[int(moved.array_over([after]).argmax())]})
            else:
                function = function.dense().product(moved.dense()).marginalise(after)
        return function


@dataclass(frozen=True, eq=False)
class _Term:
    """One reward term of the blocks of a stack.

    Attributes
    ----------
    stack, position : int
    reward : Factor
    alike : bool
        Whether the members' local functions are over the same variables, to be added up at once.
    axes : tuple of int
        Those of the next variables whose predicted mass is all that a local function takes from the belief, if so.
    """

    stack: int
    position: int
    reward: Factor
    alike: bool
    axes: tuple[int, ...]


def _are_alike(plan: StackPlan, reward: Factor) -> bool:
    pattern = plan.stack.pattern
    factors = (reward, *pattern.transition.values(), *pattern.likelihood.values())
    mentioned = {variable.name for factor in factors for variable in factor.scope}
    return not (plan.stack.own - {seen.name for seen in plan.seen}) & mentioned


def _mass(array: np.ndarray, shape: tuple[int, ...], axes: Sequence[int]) -> np.ndarray:
    """Mass of all members together over some of a block's axes, in the order asked for."""
    from factored_pomdp.beliefs.kernels import row_sums

    leading = list(axes) == list(range(len(axes)))
    kept = shape[: len(axes)] if leading else shape
    mass = np.empty(kept)
    row_sums(np.ascontiguousarray(array).reshape(mass.size, -1), mass.ravel())
    if leading:
        return mass
    left = sorted(axes)
    mass = mass.sum(axis=tuple(axis for axis in range(len(shape)) if axis not in axes))
    return mass.transpose([left.index(axis) for axis in axes])


def _expected(weights: Factor, factors: list[Factor], inner: set[Variable]) -> Factor:
    """Sum over hidden variables and what is seen of them (``inner``) of weights · reward · likelihoods."""
    reward, others = factors[0], factors[1:]
    if len(others) == 1 and isinstance(others[0], NoisyOr) and not set(others[0].cause_variables) & inner:
        noisy = others[0]
        inside = {*noisy.context, noisy.child}
        if set(reward.scope) <= inside and set(weights.scope) == set(noisy.context):
            if set(reward.scope) <= {noisy.child}:
                payoff = reward.array_over([noisy.child]).reshape(1, -1)
            else:
                payoff = np.broadcast_to(
                    reward.array_over([*noisy.context, noisy.child]), [v.size for v in (*noisy.context, noisy.child)]
                ).reshape(count(noisy.context), noisy.child.size)
            return ExpectedNoisyOr.of(noisy, weights.array_over(noisy.context).ravel(), payoff)
    keep = [v for factor in (weights, *factors) for v in factor.scope if v not in inner]
    return contract([weights, *factors], keep) if factors else constant(0.0)


def _given(factor: Factor, known: Mapping[str, Value], rename: Mapping[str, str] | None = None) -> dict[str, Value]:
    """Known values of variables in a factor's scope, whose names may be those of a pattern."""
    own = {name: (rename or {}).get(name, name) for name in factor.names}
    return {name: known[own[name]] for name in factor.names if known.get(own[name]) is not None}


def _readable(factor: Factor, known: Mapping[str, Value]) -> bool:
    return all(known[name] is not None for name in factor.names if name in known)
