"""Upper bounds of one vector an action: QMDP, and the fast informed bound.

QMDP (Littman, Cassandra, Kaelbling, ICML 1995) sees every state after one step; the fast informed bound (Hauskrecht,
"Value-function approximations for partially observable Markov decision processes", JAIR 2000) gets one observation
first and is never looser. Both are held from above: they may be stopped at any time. Time of a fast informed sweep:
entries of ``P(z, s' | s, a)`` times actions. As policies both take what they bound for what they get.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from factored_pomdp.model import FactoredPOMDP
from solvers.base import Ability
from solvers.blind import blind_stages
from solvers.flat import FlatModel, can_flatten, flatten
from solvers.mdp import state_values, values_to_go
from solvers.policy import Stage, VectorPolicy
from solvers.solution import Clock, Limits, Solution

__all__ = ["FIB", "QMDP", "informed_vectors", "qmdp_vectors"]

_MOST_SWEEPS = 2_000
_CLOSE = 1e-6


def qmdp_vectors(flat: FlatModel) -> Float[np.ndarray, "actions states"]:
    """``Q(a, s)`` of the observed model; its maximum over a at a belief is an upper bound."""
    from solvers.sweeps import action_values

    return action_values(flat, state_values(flat))


def informed_vectors(
    flat: FlatModel, sweeps: int = _MOST_SWEEPS, seconds: float = np.inf
) -> Float[np.ndarray, "actions states"]:
    """The fast informed bound's vectors, from above, improved until they stand or the time is used up."""
    import time

    from solvers.sweeps import informed_sweep

    vectors = qmdp_vectors(flat)
    legal = flat.tables.legal
    scale = max(1.0, float(np.abs(vectors[legal]).max()))
    start = np.inf
    for _ in range(sweeps):
        better = informed_sweep(flat.tables, vectors)
        start = min(start, time.perf_counter())  # the first sweep may have been compiled before it ran
        change = float((vectors[legal] - better[legal]).max())
        vectors = np.minimum(vectors, better)
        if change <= _CLOSE * scale * (1 - flat.discount) or time.perf_counter() - start > seconds:
            break
    return vectors


def informed_to_go(flat: FlatModel, horizon: int) -> list[Float[np.ndarray, "actions states"]]:
    """The fast informed bound with 1, 2, … steps to go."""
    from solvers.sweeps import informed_sweep

    stages = [np.where(flat.tables.legal, flat.reward, -np.inf)]
    while len(stages) < horizon:
        stages.append(informed_sweep(flat.tables, stages[-1]))
    return stages


class _Bound:
    name = ""

    def __init__(self, model: FactoredPOMDP) -> None:
        self.flat = flatten(model)

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where the flat tables fit."""
        return can_flatten(model)

    def solve(self, limits: Limits = Limits()) -> Solution:  # noqa: B008
        """The bound at the initial belief, with the value of the best blind policy below it."""
        clock = Clock(limits, self.flat)
        upper = [self._vectors()] if limits.horizon is None else self._to_go(limits.horizon)
        lower = blind_stages(self.flat, limits.horizon)
        stages = tuple(Stage(low, high) for low, high in zip(lower, upper, strict=True))
        return clock.solution(VectorPolicy(self.flat, self.name, stages, "upper bound", limits.horizon))

    def _vectors(self) -> Float[np.ndarray, "actions states"]:
        raise NotImplementedError

    def _to_go(self, horizon: int) -> list[Float[np.ndarray, "actions states"]]:
        raise NotImplementedError


class QMDP(_Bound):
    """Upper bound and policy: as if every state were seen from the next step on."""

    name = "qmdp"
    summary = "upper bound: as if every state were seen from the next step on"
    limits = Limits

    def _vectors(self) -> Float[np.ndarray, "actions states"]:
        return qmdp_vectors(self.flat)

    def _to_go(self, horizon: int) -> list[Float[np.ndarray, "actions states"]]:
        return values_to_go(self.flat, horizon)


class FIB(_Bound):
    """The fast informed bound, and the policy that takes it for the truth."""

    name = "fib"
    summary = "fast informed bound: every state is seen, one observation late"
    limits = Limits

    def _vectors(self) -> Float[np.ndarray, "actions states"]:
        return informed_vectors(self.flat)

    def _to_go(self, horizon: int) -> list[Float[np.ndarray, "actions states"]]:
        return informed_to_go(self.flat, horizon)
