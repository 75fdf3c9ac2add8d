"""Random factors of every representation, each beside its table as a plain dictionary that none of ours computed."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from hypothesis import strategies as st
from scipy import sparse

from factored_pomdp.factors import (
    Cause,
    DenseFactor,
    DeterministicFactor,
    ExpectedNoisyOr,
    Factor,
    NoisyOr,
    SparseFactor,
)
from factored_pomdp.variables import Variable
from tests.strategies import random_module_as_found

__all__ = ["KINDS", "PlainTable", "as_plain", "assignments", "factors", "plain_noisy_or"]

POOL = (
    Variable("a", ["no", "yes"]),
    Variable("b", [(0, 0), (0, 1), (1, 1)]),
    Variable("c", ["only"]),
    Variable("d", [3, 1, 2]),
    Variable("e", [False, True]),
)
KINDS = ("dense", "sparse", "deterministic", "noisy-or", "expected noisy-or")


@dataclass(frozen=True)
class PlainTable:
    """A scope's names and a number for every assignment, keyed by the values in that order."""

    names: tuple[str, ...]
    numbers: Mapping[tuple, float]


def assignments(variables: tuple[Variable, ...]) -> Iterator[dict[str, object]]:
    for values in itertools.product(*(variable.values for variable in variables)):
        yield {variable.name: value for variable, value in zip(variables, values, strict=True)}


def as_plain(factor: Factor) -> PlainTable:
    """What a factor says, read off its full table."""
    numbers = factor.dense().array.ravel().tolist()
    keys = itertools.product(*(variable.values for variable in factor.dense().scope))
    return PlainTable(factor.dense().names, dict(zip(keys, numbers, strict=True)))


@st.composite
def factors(draw: st.DrawFn, kinds: tuple[str, ...] = KINDS) -> tuple[Factor, PlainTable]:
    """A factor over up to three variables, and its table."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    scope = tuple(draw(st.permutations(POOL)))[: draw(st.integers(1, 3))]
    kind = draw(st.sampled_from(kinds))
    with random_module_as_found():
        return _MAKERS[kind](rng, scope)


def _table(scope: tuple[Variable, ...], array: np.ndarray) -> PlainTable:
    keys = itertools.product(*(variable.values for variable in scope))
    return PlainTable(tuple(v.name for v in scope), dict(zip(keys, array.ravel().tolist(), strict=True)))


def _numbers(rng: np.random.Generator, scope: tuple[Variable, ...]) -> np.ndarray:
    shape = [variable.size for variable in scope]
    return np.where(rng.random(shape) < 0.4, 0.0, np.round(rng.normal(size=shape), 2))


def _dense(rng: np.random.Generator, scope: tuple[Variable, ...]) -> tuple[Factor, PlainTable]:
    array = _numbers(rng, scope)
    return DenseFactor(scope, array), _table(scope, array)


def _sparse(rng: np.random.Generator, scope: tuple[Variable, ...]) -> tuple[Factor, PlainTable]:
    array = _numbers(rng, scope)
    stored = (array != 0) | (rng.random(array.shape) < 0.2)
    order = rng.permutation(int(stored.sum()))
    return SparseFactor(scope, np.argwhere(stored)[order], array[stored][order]), _table(scope, array)


def _deterministic(rng: np.random.Generator, scope: tuple[Variable, ...]) -> tuple[Factor, PlainTable]:
    *parents, child = scope
    indexes = rng.integers(child.size, size=[parent.size for parent in parents])
    array = np.zeros([variable.size for variable in scope])
    for place in np.ndindex(*indexes.shape):
        array[(*place, indexes[place])] = 1.0
    return DeterministicFactor(parents, child, indexes), _table(scope, array)


def _causes(rng: np.random.Generator, variables: tuple[Variable, ...], contexts: int, child: Variable) -> list[Cause]:
    causes = []
    for variable in (*variables, *([None] if rng.random() < 0.5 else [])):
        emission = np.zeros((contexts, child.size))
        emission[:, 1:] = rng.dirichlet(np.ones(child.size - 1), size=contexts)
        chance = np.clip(rng.normal(0.5, 0.6, (1 if variable is None else variable.size, contexts)), 0, 1)
        causes.append(Cause(variable, chance, sparse.csr_array(emission)))
    return causes


def plain_noisy_or(noisy: NoisyOr, given: Mapping[str, object]) -> float:
    """The number at one assignment, cause after cause."""
    context = 0
    for variable in noisy.context:
        context = context * variable.size + variable.values.index(given[variable.name])
    shown = noisy.child.values.index(given[noisy.child.name])
    silent, total = 1.0, 0.0
    for cause in noisy.causes:
        row = 0 if cause.variable is None else cause.variable.values.index(given[cause.variable.name])
        acts = float(cause.activation[row, context])
        total += silent * acts * float(cause.emission.toarray()[context, shown])
        silent *= 1 - acts
    return total + (silent if given[noisy.child.name] == noisy.off else 0.0)


def _noisy_or(rng: np.random.Generator, scope: tuple[Variable, ...]) -> tuple[Factor, PlainTable]:
    child = Variable("seen", ["nothing", "left", "right"])
    context, parents = scope[:1], scope[1:]
    size = int(np.prod([variable.size for variable in context]))
    noisy = NoisyOr(context, child, "nothing", _causes(rng, parents, size, child))
    numbers = {tuple(given.values()): plain_noisy_or(noisy, given) for given in assignments(noisy.scope)}
    return noisy, PlainTable(noisy.names, numbers)


def _expected(rng: np.random.Generator, scope: tuple[Variable, ...]) -> tuple[Factor, PlainTable]:
    child = Variable("seen", ["nothing", "left", "right"])
    context = Variable("place", range(3))
    noisy = NoisyOr([context], child, "nothing", _causes(rng, scope, 3, child))
    weights, payoff = rng.normal(size=3), rng.normal(size=(1 if rng.random() < 0.5 else 3, 3))
    numbers = {
        tuple(given.values()): sum(
            weights[place] * payoff[place % len(payoff), shown] * plain_noisy_or(noisy, {**given, **more})
            for place in range(3)
            for shown, value in enumerate(child.values)
            for more in [{"place": place, "seen": value}]
        )
        for given in assignments(scope)
    }
    return ExpectedNoisyOr.of(noisy, weights, payoff), PlainTable(tuple(v.name for v in scope), numbers)


_MAKERS = {
    "dense": _dense,
    "sparse": _sparse,
    "deterministic": _deterministic,
    "noisy-or": _noisy_or,
    "expected noisy-or": _expected,
}
