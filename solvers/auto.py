"""Choose a solver by what the model is, and say why.

With a horizon: exact alpha vectors where states are few, else the fast informed bound. Without: point-based where the
flat tables fit. A model too large for that, but which decomposes: a proved upper bound from its blocks, each with the
actions to itself, and as lower estimate what the myopic policy earns in simulation, marked as statistical.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from factored_pomdp.beliefs.plan import plan_of
from factored_pomdp.episodes import Returns, episodes, steps_that_matter
from factored_pomdp.model import FactoredPOMDP
from solvers.base import Ability
from solvers.block_bounds import block_bound
from solvers.exact import Exact
from solvers.flat import can_flatten
from solvers.myopic import DecomposedMyopic
from solvers.point_based import PointBased
from solvers.policy import VectorPolicy
from solvers.policy_files import load_policy
from solvers.solution import Limits, Progress, Solution, Stopwatch
from solvers.upper_bounds import FIB

__all__ = ["Auto"]

_FEW_STATES = 30
_RUNS = 400
_FEWEST_RUNS = 10
_TRIED = 2
_SURE = 0.99


class Auto:
    """The solver that fits, chosen by size, known variables and horizon.

    Parameters
    ----------
    model : FactoredPOMDP
    """

    name = "auto"
    summary = "chooses one of the others, and says why"
    limits = Limits

    def __init__(self, model: FactoredPOMDP) -> None:
        self.model = model

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        """Yes where one of the solvers that it chooses from can; which one, and why, for no horizon."""
        flat = can_flatten(model)
        if flat:
            kind = PointBased.name if model.discount < 1 else "exact or fib, with a horizon"
            return Ability(True, f"takes {kind}: {flat.because}", flat.estimate)
        myopic = DecomposedMyopic.can_solve(model)
        if myopic and len(plan_of(model).structure.blocks) > 1:
            because = f"too large to flatten, but decomposes: {myopic.because}; bounds from blocks and simulation"
            return Ability(True, because, myopic.estimate)
        return Ability(False, f"{flat.because}; and it does not decompose", flat.estimate)

    @staticmethod
    def load_policy(path: Path, model: FactoredPOMDP) -> VectorPolicy:
        """A policy that was saved, whichever solver made it."""
        return load_policy(path, model)

    def solve(self, limits: Limits = Limits()) -> Solution:  # noqa: B008
        """Hand the model to the solver that fits; its answer carries the reason as its first note."""
        from dataclasses import replace

        model = self.model
        if limits.horizon is None and model.discount >= 1:
            raise ValueError(f"{model.name} has discount 1: values without a horizon are not finite; give a horizon")
        flat = can_flatten(model)
        if not flat:
            return self._by_blocks(limits, flat.because)
        solver: Any
        if limits.horizon is None:
            solver, because = PointBased(model), f"point-based: no horizon, and the flat tables fit ({flat.because})"
        elif model.joint_states <= _FEW_STATES:
            solver, because = Exact(model), f"exact: a horizon, and only {model.joint_states} joint states"
        else:
            solver = FIB(model)
            because = f"fib: a horizon, and {model.joint_states:,} joint states are too many for exact vectors"
        found: Solution = solver.solve(limits)
        return replace(found, notes=(because, *found.notes))

    def _by_blocks(self, limits: Limits, too_large: str) -> Solution:
        watch = Stopwatch(limits.time_limit)
        model = self.model
        half = None if limits.time_limit is None else limits.time_limit / 2
        upper, notes = block_bound(model, limits.horizon, half)
        steps = limits.horizon or self._affordable(steps_that_matter(model), watch)
        returns, lower, stopped = Returns(model, steps), -math.inf, "solved"
        try:
            for number, total in enumerate(episodes(model, DecomposedMyopic(model), _RUNS, steps, seed=0), 1):
                returns.add(total)
                if number > 1:
                    lower = returns.interval(_SURE)[0] - (returns.truncation_error if limits.horizon is None else 0.0)
                    if limits.progress is not None:
                        limits.progress(Progress(lower, upper, 0, 0, watch.seconds))
                if watch.is_over and number >= _FEWEST_RUNS:
                    stopped = "time limit"
                    break
        except KeyboardInterrupt:
            stopped = "interrupted"
        said = (
            f"blocks: {too_large}; the model decomposes",
            *notes,
            f"lower: {_SURE:.0%} confidence, {len(returns)} runs of {steps} steps of the myopic policy; not proved",
        )
        return Solution(
            "myopic", lower, upper, watch.seconds, limits.horizon, 0, 0, stopped, None, said, lower_is="statistical"
        )

    def _affordable(self, steps: int, watch: Stopwatch) -> int:
        """So many of the steps that the fewest runs come to an end within the time that is left."""
        if watch.left is None:
            return steps
        pace = 0.0
        for _ in range(2):  # the first time may compile
            started = watch.seconds
            list(episodes(self.model, DecomposedMyopic(self.model), 1, _TRIED, seed=0))
            pace = (watch.seconds - started) / _TRIED
        return max(1, min(steps, int(watch.left / max(pace, 1e-9) / _FEWEST_RUNS)))
