"""Runs of a policy in a simulated model: discounted returns, their interval, what ending early leaves out."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, TextIO

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.simulation import Simulation
from factored_pomdp.trace import record
from factored_pomdp.variables import Value

__all__ = ["Returns", "episodes", "largest_reward", "steps_that_matter"]

_LEFT_OUT = 1e-3
_MOST_STEPS = 100_000


def largest_reward(model: FactoredPOMDP) -> float:
    """No step earns or costs more than this (terms are bounded one by one)."""
    return sum(float(np.abs(_numbers(factor)).max(initial=0.0)) for factor in model.reward.values())


def steps_that_matter(model: FactoredPOMDP) -> int:
    """So many steps that what comes after is worth less than a thousandth of the largest reward."""
    if model.discount >= 1:
        return _MOST_STEPS
    if model.discount <= 0:
        return 1
    return min(_MOST_STEPS, math.ceil(math.log(_LEFT_OUT * (1 - model.discount)) / math.log(model.discount)))


def episodes(
    model: FactoredPOMDP, actor: Any, runs: int, steps: int, seed: int, trace: TextIO | None = None
) -> Iterator[float]:
    """The discounted return of each run.

    Parameters
    ----------
    actor : object
        With ``start()``, which gives a belief, and ``decide(belief)``; ``values(belief)`` lists actions with values.
    seed : int
        Run r draws from the generator with seed ``[seed, r]``, whatever the other runs did.
    trace : text file, optional
        Gets a line of JSON a step (`factored_pomdp.trace`).
    """
    world = Simulation(model)
    for run in range(runs):
        rng = np.random.default_rng([seed, run])
        state, belief, total, weight = world.start(rng), actor.start(), 0.0, 1.0
        for step in range(steps):
            if model.is_terminal(state):
                break
            decision = actor.decide(belief)
            after, seen, reward = world.step(state, decision.action, rng)
            if trace is not None:
                valued = actor.values(belief) if hasattr(actor, "values") else None
                line = {"run": run, "step": step} | record(model, state, belief, decision, valued, seen, reward)
                trace.write(json.dumps(line, ensure_ascii=False) + "\n")
            total += weight * reward
            weight *= model.discount
            ended = model.is_terminal(after)
            if not ended:
                belief = belief.predict(decision.action).condition(seen, known=_read_back(model, after))
            state = after
        yield total


def _read_back(model: FactoredPOMDP, state: Mapping[str, Value]) -> dict[str, Value]:
    from factored_pomdp.beliefs.plan import plan_of

    known = plan_of(model).structure.known
    return {name: state[name] for name in known if name in model.declared_known}


class Returns:
    """Discounted returns, gathered one by one.

    Attributes
    ----------
    truncation_error : float
        What further steps could have added or taken away at the most; nothing where every run ended of itself.
    """

    def __init__(self, model: FactoredPOMDP, steps: int) -> None:
        self._totals: list[float] = []
        rest = model.discount**steps / (1 - model.discount) if model.discount < 1 else math.inf
        self.truncation_error = rest * largest_reward(model) if model.discount < 1 else 0.0

    def __len__(self) -> int:
        return len(self._totals)

    def add(self, total: float) -> None:
        """One more run."""
        self._totals.append(total)

    @property
    def mean(self) -> float:
        return float(np.mean(self._totals))

    def interval(self, level: float) -> tuple[float, float]:
        """Confidence interval of the mean (Student's t)."""
        from scipy import stats

        half = float(stats.t.ppf(0.5 + level / 2, len(self) - 1)) * float(np.std(self._totals, ddof=1))
        half /= math.sqrt(len(self))
        return self.mean - half, self.mean + half


def _numbers(factor: Any) -> np.ndarray:
    return np.asarray(factor.sparse().numbers)
