"""Small random models for property tests: `random_models` with ties of any kind, `independent_models` without.

Hypothesis draws the structure (and shrinks it); the numbers come from a generator with a drawn seed.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from hypothesis import strategies as st
from scipy import sparse

import factored_pomdp as fp
from factored_pomdp.factors import DenseFactor, DeterministicFactor, Factor, NoisyOr
from factored_pomdp.variables import count

__all__ = ["independent_models", "random_beliefs", "random_distribution", "random_models"]

TIES = ("initial", "transition", "observation", "reward")


def random_models(most_states: int = 4, ties: Sequence[str] = TIES) -> st.SearchStrategy[fp.FactoredPOMDP]:
    """Models with 1 to 4 state variables of 2 or 3 values, some known, and a drawn choice of kinds of ties."""
    return _models(st.integers(1, most_states), st.lists(st.sampled_from(ties), unique=True) if ties else st.just([]))


def independent_models(most_states: int = 4) -> st.SearchStrategy[fp.FactoredPOMDP]:
    """Models of at least two hidden variables, none of which is tied to another: they decompose by construction."""
    return _models(st.integers(2, most_states), st.just([]), fewest_hidden=2)


def random_distribution(rng: np.random.Generator, shape: tuple[int, ...], *, sparse_too: bool = True) -> np.ndarray:
    """Distributions over the last axis; some have zeros, some are certain."""
    array = rng.dirichlet(np.ones(shape[-1]), size=shape[:-1])
    if sparse_too:
        keep = rng.random(array.shape) < rng.choice([0.5, 1.0])
        keep |= np.arange(shape[-1]) == rng.integers(shape[-1], size=shape[:-1])[..., None]
        array = array * keep
    return array / array.sum(axis=-1, keepdims=True)


@st.composite
def random_beliefs(draw: st.DrawFn, model: fp.FactoredPOMDP) -> fp.ProductBelief:
    """A random product belief of a model, known values as they start."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    with random_module_as_found():
        start = fp.initial_belief(model)
        return start.with_arrays(random_distribution(rng, array.shape[::-1]).T for array in start.arrays)


@st.composite
def _models(
    draw: st.DrawFn, sizes: st.SearchStrategy, ties: st.SearchStrategy, fewest_hidden: int = 1
) -> fp.FactoredPOMDP:
    with random_module_as_found():
        number = draw(sizes)
        hidden_count = draw(st.integers(min(number, fewest_hidden), number))
        rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
        hidden = [_variable(draw, f"h{k}") for k in range(hidden_count)]
        known = [_variable(draw, f"k{k}") for k in range(number - hidden_count)]
        actions = [_variable(draw, f"a{k}", 2) for k in range(draw(st.integers(1, 2)))]
        return _World(draw, rng, hidden, known, actions, set(draw(ties))).model()


@contextmanager
def random_module_as_found() -> Iterator[None]:
    """Type checks at run time draw from `random` which item of a container to look at; hypothesis forbids it here."""
    state = random.getstate()
    try:
        yield
    finally:
        random.setstate(state)


@dataclass
class _World:
    draw: st.DrawFn
    rng: np.random.Generator
    hidden: list[fp.Variable]
    known: list[fp.Variable]
    actions: list[fp.Variable]
    ties: set[str]
    declared: list[str] = field(default_factory=list)
    planned: list[fp.Variable] = field(default_factory=list)

    def model(self) -> fp.FactoredPOMDP:
        observations = [_variable(self.draw, f"o{k}") for k in range(self.draw(st.integers(1, 2)))]
        return fp.FactoredPOMDP(
            name="random",
            states=self.draw(st.permutations([*self.hidden, *self.known])),
            actions=self.actions,
            observations=observations,
            transition=self._known_transitions() | self._hidden_transitions(),
            observation={seen.name: self._observation(seen) for seen in observations},
            reward={f"r{k}": self._reward(observations, k == 0) for k in range(self.draw(st.integers(1, 3)))},
            initial=self._initial(),
            discount=0.9,
            known=self.declared,
            legal=self._legal(),
        )

    def _some(self, variables: Sequence[fp.Variable], most: int = 2) -> list[fp.Variable]:
        if not variables:
            return []
        return self.draw(st.lists(st.sampled_from(list(variables)), unique=True, max_size=most))

    def _maybe(self) -> bool:
        return self.draw(st.booleans())

    def _table(self, parents: Sequence[fp.Variable], child: fp.Variable) -> DenseFactor:
        scope = [*parents, child]
        return DenseFactor(scope, random_distribution(self.rng, tuple(variable.size for variable in scope)))

    def _hidden_transitions(self) -> dict[str, Factor]:
        found = {}
        for position, variable in enumerate(self.hidden):
            parents = [variable] if self._maybe() else []
            parents += self._some([*self.known, *self.actions])
            if self.planned and self.draw(st.integers(0, 4)) == 0:
                parents.append(self.draw(st.sampled_from(self.planned)).next)
            if "transition" in self.ties and len(self.hidden) > 1:
                before = [other.next for other in self.hidden[:position]]
                parents += self._some([other for other in self.hidden if other != variable] + before, 1)
            found[variable.name] = self._table(parents, variable.next)
        return found

    def _known_transitions(self) -> dict[str, Factor]:
        found: dict[str, Factor] = {}
        for position, variable in enumerate(self.known):
            parents = self._some([variable, *self.known[:position], *self.actions])
            kind = self.draw(st.sampled_from(["planned", "planned and read", "random and read", "influenced and read"]))
            if kind.startswith("planned"):
                self.planned.append(variable)
                indexes = self.rng.integers(variable.size, size=[parent.size for parent in parents])
                found[variable.name] = DeterministicFactor(parents, variable.next, indexes)
            else:
                influence = [self.draw(st.sampled_from(self.hidden))] if kind.startswith("influenced") else []
                found[variable.name] = self._table([*influence, *parents], variable.next)
            if kind.endswith("read"):
                self.declared.append(variable.name)
        return found

    def _initial(self) -> dict[str, Factor]:
        found: dict[str, Factor] = {}
        for position, variable in enumerate(self.hidden):
            tied = "initial" in self.ties and position and self._maybe()
            found[variable.name] = self._table([self.hidden[position - 1]] if tied else [], variable)
        for variable in self.known:
            found[variable.name] = DeterministicFactor((), variable, int(self.rng.integers(variable.size)))
        return found

    def _observation(self, seen: fp.Variable) -> Factor:
        about = [variable.next for variable in self._some(self.hidden, 2 if "observation" in self.ties else 1)]
        others = self._some([*self._after(), *self.actions])
        if len(about) == 1 and others and self._maybe():
            return self._noisy_or(about, others, seen)
        return self._table([*about, *others], seen)

    def _noisy_or(self, context: list[fp.Variable], causes: list[fp.Variable], seen: fp.Variable) -> NoisyOr:
        off = int(self.rng.integers(seen.size))
        shown = random_distribution(self.rng, (count(context), seen.size - 1))
        emission = sparse.csr_array(np.insert(shown, off, 0.0, axis=1))
        parts = [
            fp.Cause(
                variable, np.round(self.rng.random((variable.size, count(context))), self.rng.integers(3)), emission
            )
            for variable in causes
        ]
        if self._maybe():
            parts.append(fp.Cause(None, 0.2 * self.rng.random((1, count(context))), emission))
        return NoisyOr(context, seen, seen.values[off], parts)

    def _reward(self, observations: list[fp.Variable], first: bool) -> DenseFactor:
        about = self._some([variable for own in self.hidden for variable in (own, own.next)], 2)
        if first and "reward" in self.ties and len(self.hidden) > 1:
            about = [self.hidden[0], self.draw(st.sampled_from(self.hidden[1:])).next]
        if "reward" not in self.ties and about:
            name = about[0].name.removesuffix(".next")
            about = [variable for variable in about if variable.name.removesuffix(".next") == name]
        seen = self._some(observations, 1) if "reward" in self.ties or not about else []
        others = self._some([*self.known, *self._after(), *self.actions])
        scope = [*about, *seen, *others]
        size = math.prod(variable.size for variable in scope)
        return DenseFactor(scope, self.rng.normal(size=size).reshape([variable.size for variable in scope]))

    def _after(self) -> list[fp.Variable]:
        """Known variables' next values; those that hidden variables influence would tie what reads them."""
        return [variable.next for variable in (self.known if "reward" in self.ties else self.planned)]

    def _legal(self) -> dict[str, DenseFactor]:
        if not self.known or self.draw(st.integers(0, 3)):
            return {}
        action, known = self.actions[0], self.known[0]
        allowed = self.rng.random((known.size, action.size)) < 0.6
        allowed[:, int(self.rng.integers(action.size))] = True
        return {action.name: DenseFactor([known, action], allowed)}


def _variable(draw: st.DrawFn, name: str, most: int = 3) -> fp.Variable:
    return fp.Variable(name, range(draw(st.integers(2, most))))
