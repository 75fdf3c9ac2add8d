"""Point-based value iteration with proved bounds on both sides, for infinite horizons.

Trials go down from the initial belief where the bounds are widest apart, and back both up (HSVI2: Smith and Simmons,
"Point-based POMDP algorithms: improved analysis and implementation", UAI 2005; the lower bound is a set of alpha
vectors, the upper one a sawtooth over the fast informed bound). Beliefs are sparse and live on one class of states that
the agent tells apart (mixed observability, as in SARSOP's MOMDP form), and so do vectors. A belief met twice is one
node; actions are looked at only where their upper bound may be the best; bounds are brought up to date by what was
improved since. Vectors are taken out only where another is nowhere below: then the policy earns its lower bound.
Memory: grows with time, up to a limit. When not to use it: where the flat tables do not fit, or for a few steps only.
"""

from __future__ import annotations

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from solvers.alpha_vectors import VectorSet
from solvers.base import Ability
from solvers.blind import blind_stages
from solvers.flat import FlatModel, can_flatten, flatten
from solvers.policy import Stage, VectorPolicy
from solvers.sawtooth import Sawtooth
from solvers.search_state import Search, grown, new_count, new_search
from solvers.solution import Clock, Limits, Progress, Solution
from solvers.upper_bounds import informed_vectors

__all__ = ["PointBased"]

_MOST_BYTES = 3_000_000_000
_WORK_OF_A_SLICE = 3_000_000
_INFORMED_SHARE = 0.1
_INFORMED_SECONDS = 20.0


class PointBased:
    """Both bounds at the initial belief, tightened until the gap, the time or the memory is reached.

    Parameters
    ----------
    model : FactoredPOMDP
    share : float
        How far a trial looks: until the gap is this share of the root's, discounted.

    Raises
    ------
    TooLarge
        Where the flat tables do not fit.
    ValueError
        Where the discount is 1.
    """

    name = "point-based"
    summary = "infinite horizon, proved lower and upper bounds, anytime"
    limits = Limits

    def __init__(self, model: FactoredPOMDP, share: float = 0.5) -> None:
        ability = self.can_solve(model)
        if not ability and model.discount >= 1:
            raise ValueError(ability.because)
        self.flat, self.share = flatten(model), share

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where the flat tables fit and the discount is below 1."""
        flat = can_flatten(model)
        if model.discount >= 1:
            return Ability(False, f"discount {model.discount:g}: an infinite horizon needs one below 1", flat.estimate)
        return Ability(flat.can, flat.because, f"{flat.estimate}; anytime, up to {_MOST_BYTES:,} bytes of beliefs")

    def solve(self, limits: Limits = Limits()) -> Solution:  # noqa: B008
        """Search until a limit is reached; Ctrl-C ends it early, with the best so far."""
        if limits.horizon is not None:
            raise ValueError(f"{self.name} plans for ever; for a horizon of {limits.horizon} take exact")
        clock = Clock(limits, self.flat)
        seconds = min(_INFORMED_SECONDS, _INFORMED_SHARE * (limits.time_limit or np.inf))
        informed = informed_vectors(self.flat, seconds=seconds)
        search = new_search(self.flat, informed, blind_stages(self.flat, None)[0])
        search, stopped = self._searched(search, clock)
        return clock.solution(_policy(self.flat, search, informed), stopped)

    def _searched(self, search: Search, clock: Clock) -> tuple[Search, str]:
        from solvers.belief_nodes import insert_all
        from solvers.point_based_kernels import run_trials

        limits, needed, support = clock.limits, new_count(), np.count_nonzero(self.flat.initial)
        work, done = _WORK_OF_A_SLICE // 10, 1
        try:
            while done:
                if clock.is_over:
                    return search, "time limit"
                needed[:] = 0
                done = run_trials(self.flat.tables, search, support, limits.precision, self.share, work, needed)
                work = _WORK_OF_A_SLICE
                if done == 2:
                    search = grown(search, needed)
                    if search.bytes_held > _MOST_BYTES:
                        return search, "memory"
                    if 2 * (search.used["nodes"] + needed["nodes"])[0] >= len(search.table):
                        search = search._replace(table=np.full(4 * len(search.table), -1))
                        insert_all(search.nodes[: search.used["nodes"][0]], search.entries, search.table)
                elif limits.progress is not None:
                    limits.progress(_progress(search, clock.seconds))
        except KeyboardInterrupt:
            return search, "interrupted"
        return search, "precision"


def _progress(search: Search, seconds: float) -> Progress:
    root, used = search.nodes[0], search.used[0]
    return Progress(float(root["lower"]), float(root["upper"]), int(used["vectors"]), int(used["points"]), seconds)


def _policy(flat: FlatModel, search: Search, informed: np.ndarray) -> VectorPolicy:
    sawtooth = _sawtooth(flat, search)
    return VectorPolicy(flat, PointBased.name, (Stage(_vectors(flat, search), informed, sawtooth),), "lower bound")


def _vectors(flat: FlatModel, search: Search) -> VectorSet:
    parts = {}
    for kind, head in enumerate(search.kinds["vector"]):
        size = int(flat.tables.class_start[kind + 1] - flat.tables.class_start[kind])
        rows, vector = [], int(head)
        while vector >= 0:
            rows.append(vector)
            vector = int(search.vectors["next"][vector])
        places = search.vectors["start"][rows][:, None] + np.arange(size)
        parts[kind] = search.numbers[places], search.vectors["action"][rows]
    return VectorSet.of(flat, parts)


def _sawtooth(flat: FlatModel, search: Search) -> Sawtooth:
    used = search.nodes[: search.used["nodes"][0]]
    nodes = used[used["next_point"] != -2]
    start = np.concatenate([[0], np.cumsum(nodes["length"])])
    places = np.repeat(nodes["start"] - start[:-1], nodes["length"]) + np.arange(start[-1])
    entries = search.entries[places]
    return Sawtooth(
        search.states["corner"].copy(), nodes["kind"], start, entries["state"], entries["chance"], nodes["upper"]
    )
