"""Runs of a policy in a simulated model: discounted returns, their interval, what ending early leaves out."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TextIO

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.simulation import Simulation
from factored_pomdp.trace import record
from factored_pomdp.variables import Value

__all__ = ["Episode", "Returns", "episodes", "largest_reward", "read_back", "steps_that_matter"]

_LEFT_OUT = 1e-3
_MOST_STEPS = 100_000


class Episode(NamedTuple):
    """One run.

    Attributes
    ----------
    total : float
        Its discounted return.
    ended : bool
        Whether it came to a terminal state; else it was cut.
    """

    total: float
    ended: bool


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
) -> Iterator[Episode]:
    """Runs, one by one.

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
            if not model.is_terminal(after):
                belief = belief.predict(decision.action).condition(seen, known=read_back(model, after))
            state = after
        yield Episode(total, model.is_terminal(state))


def read_back(model: FactoredPOMDP, state: Mapping[str, Value]) -> dict[str, Value]:
    """What is read back in a state, beside the observation."""
    from factored_pomdp.beliefs.plan import plan_of

    known = plan_of(model).structure.known
    return {name: state[name] for name in known if name in model.declared_known}


class Returns:
    """Discounted returns, gathered one by one.

    Parameters
    ----------
    steps : int
        After which runs are cut.

    Attributes
    ----------
    cut : int
        Runs that had not come to a terminal state by then (without terminal states: all).
    """

    def __init__(self, model: FactoredPOMDP, steps: int) -> None:
        self.cut = 0
        self._model, self._steps = model, steps
        self._totals: list[float] = []

    def __len__(self) -> int:
        return len(self._totals)

    def add(self, episode: Episode) -> None:
        """One more run."""
        self._totals.append(episode.total)
        self.cut += not episode.ended

    @property
    def truncation_error(self) -> float:
        """What further steps could have added to the mean, or taken away, at the most.

        Runs that ended of themselves leave nothing out. Of runs that were cut nothing is known where the discount is 1
        (infinity), unless the model has no terminal states: then the number of steps is the problem's own horizon.
        """
        discount = self._model.discount
        if not self.cut or (discount >= 1 and self._model.terminal is None):
            return 0.0
        if discount >= 1:
            return math.inf
        rest = discount**self._steps / (1 - discount) * largest_reward(self._model)
        return rest * self.cut / len(self)

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
