"""The exponential solver against the linear decomposition: values, chosen actions and posteriors, in numbers.

On random product beliefs, and along simulated runs, both solvers value every joint action, and both beliefs are carried
through the same action and observation. A run that ends in a terminal state starts anew; where a step ends there is no
posterior to compare, as nobody acts on it. The solvers are reached through the registry, by name.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from factored_pomdp import registry
from factored_pomdp.beliefs import JointBelief, ProductBelief, initial_belief
from factored_pomdp.beliefs.comparison import Comparison, joint_of, random_product_belief, sampled_state, spelled_out
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.simulation import Simulation
from factored_pomdp.variables import Value

__all__ = ["TOLERANCE", "Difference", "Verification", "verifications", "verify"]

TOLERANCE = 1e-9
"""Largest difference of values (relative where they pass one) and of probabilities that is rounding."""


@dataclass(frozen=True)
class Difference:
    """The first difference above `TOLERANCE`, whole.

    Attributes
    ----------
    what : str
        ``value``, ``action`` or ``belief``.
    where : str
        Which random belief, or which step of which run.
    belief : dict
        The product belief before the action: block or known variable to its probabilities or value.
    action, observation : dict or None
    at : str
        For a belief the state whose probability differs.
    joint, decomposed : float
        The two numbers.
    """

    what: str
    where: str
    belief: Mapping[str, Any]
    action: Mapping[str, Value]
    observation: Mapping[str, Value] | None
    at: str
    joint: float
    decomposed: float


@dataclass(frozen=True)
class Verification:
    """What was found so far.

    Attributes
    ----------
    beliefs, steps : int
        Random beliefs, and steps of simulated runs, that were compared.
    max_value_difference, max_belief_difference : float
    actions_agree : float
        Share of decisions where the decomposition's action is worth the joint optimum, within `TOLERANCE`.
    joint_seconds, decomposed_seconds : float
        Time spent on decisions and belief updates.
    first_difference : Difference or None
    """

    beliefs: int = 0
    steps: int = 0
    max_value_difference: float = 0.0
    max_belief_difference: float = 0.0
    actions_agree: float = 1.0
    joint_seconds: float = 0.0
    decomposed_seconds: float = 0.0
    first_difference: Difference | None = None

    @property
    def holds(self) -> bool:
        """Whether nothing differed by more than rounding."""
        return self.first_difference is None


def verify(
    model: FactoredPOMDP,
    beliefs: int,
    steps: int,
    rng: np.random.Generator,
    *,
    runs: int = 1,
    sparse: bool = False,
) -> Verification:
    """Compare on random beliefs and along simulated runs; see `verifications`."""
    found = [Verification(), *verifications(model, beliefs, steps, rng, runs=runs, sparse=sparse)]
    return found[-1]


def verifications(
    model: FactoredPOMDP,
    beliefs: int,
    steps: int,
    rng: np.random.Generator,
    *,
    runs: int = 1,
    sparse: bool = False,
) -> Iterator[Verification]:
    """As `verify`, telling what was found after every comparison, so that it can be watched and cut short.

    Parameters
    ----------
    beliefs : int
        How many random product beliefs: each block's drawn dense, sparse or certain; known values as a walk of legal
        random actions reaches them.
    steps : int
        Length of each simulated run, in which the decomposition decides.
    rng : numpy Generator
    runs : int
        How many simulated runs (where ``steps`` is not zero).
    sparse : bool
        Whether the joint belief holds only the states that have mass.

    Raises
    ------
    TooLarge
        With the sizes, before anything is allocated.
    """
    tally = _Tally(model, sparse, rng)
    state = tally.start()
    for number in range(1, beliefs + 1):
        product = random_product_belief(model, state, rng)
        joint = joint_of(product, sparse)
        action = tally.compare_decisions(product, joint, f"random belief {number}").drawn
        tally.carry(product, joint, sampled_state(product, rng), action, f"random belief {number}")
        state = tally.world.step(state, tally.legal_action(state), rng)[0]
        state = tally.start() if model.is_terminal(state) else state
        tally.beliefs += 1
        yield tally.verification()
    for run in range(1, runs + 1 if steps else 1):
        product, joint, state = tally.beginning()
        for step in range(1, steps + 1):
            where = f"run {run}, step {step}"
            action = tally.compare_decisions(product, joint, where).chosen
            product, joint, state = tally.carry(product, joint, state, action, where) or tally.beginning()
            tally.steps += 1
            yield tally.verification()


@dataclass(frozen=True)
class _Actions:
    chosen: Mapping[str, Value]
    drawn: Mapping[str, Value]


@dataclass
class _Tally:
    model: FactoredPOMDP
    sparse: bool
    rng: np.random.Generator
    beliefs: int = 0
    steps: int = 0
    decisions: int = 0
    agreed: int = 0
    value: float = 0.0
    belief: float = 0.0
    seconds: dict[str, float] = field(default_factory=lambda: {"joint": 0.0, "decomposed": 0.0})
    first: Difference | None = None

    def __post_init__(self) -> None:
        self.joint = registry.solver("myopic-joint")(self.model, sparse=self.sparse)
        self.decomposed = registry.solver("myopic")(self.model)
        self.world = Simulation(self.model)
        known = initial_belief(self.model).known
        self.read_back = [name for name in known if name in self.model.declared_known]
        self._warm_up()

    def _warm_up(self) -> None:
        """One untimed step, so that what is compiled on first use is not counted."""
        start = initial_belief(self.model)
        action = self.decomposed.decide(start).action
        after, seen, _ = self.world.step(sampled_state(start, self.rng), action, self.rng)
        if not self.model.is_terminal(after):
            start.predict(action).condition(seen, known={name: after[name] for name in self.read_back})

    def compare_decisions(self, product: ProductBelief, joint: JointBelief, where: str) -> _Actions:
        """V(B, A) of every legal joint action both ways, and what the decomposition chooses."""
        with self._timed("joint"):
            valued = self.joint.values(joint)
        with self._timed("decomposed"):
            decision = self.decomposed.decide(product)
        functions = self.decomposed.local_functions(product)
        best = max(value for _, value in valued)
        reached = -math.inf
        for action, value in valued:
            ours = sum(float(function.condition(action).dense().array) for function in functions)
            self._note_value(value, ours, product, action, where)
            if action == decision.action:
                reached = value
                self._note_value(value, decision.value, product, action, where)
        self.decisions += 1
        if best - reached <= TOLERANCE * max(1.0, abs(best)):
            self.agreed += 1
        else:
            self._note("action", where, product, decision.action, None, "", best, reached)
        return _Actions(decision.action, valued[int(self.rng.integers(len(valued)))][0])

    def carry(
        self,
        product: ProductBelief,
        joint: JointBelief,
        state: Mapping[str, Value],
        action: Mapping[str, Value],
        where: str,
    ) -> tuple[ProductBelief, JointBelief, dict[str, Value]] | None:
        """Both beliefs through one action and what the world then shows; ``None`` where the episode ends there."""
        after, seen, _ = self.world.step(state, action, self.rng)
        if self.model.is_terminal(after):
            return None
        known = {name: after[name] for name in self.read_back}
        with self._timed("joint"):
            joint_after = joint.predict(action).condition(seen, known=known)
        with self._timed("decomposed"):
            product_after = product.predict(action).condition(seen, known=known)
        worst = Comparison.of(joint_after, product_after).worst()
        self.belief = max(self.belief, abs(worst.joint - worst.product))
        if abs(worst.joint - worst.product) > TOLERANCE:
            self._note("belief", where, product, action, {**seen, **known}, worst.at, worst.joint, worst.product)
        return product_after, joint_after, after

    def start(self) -> dict[str, Value]:
        """An initial state that is not terminal (there is one: the initial beliefs were made)."""
        while self.model.is_terminal(state := self.world.start(self.rng)):
            pass
        return state

    def beginning(self) -> tuple[ProductBelief, JointBelief, dict[str, Value]]:
        """Both initial beliefs, and a state to start from."""
        return initial_belief(self.model), JointBelief.initial(self.model, self.sparse), self.start()

    def legal_action(self, state: Mapping[str, Value]) -> dict[str, Value]:
        """A random joint action that is legal in a state."""
        while True:
            action = {v.name: v.values[int(self.rng.integers(v.size))] for v in self.model.actions}
            if self.model.is_legal(action, state):
                return action

    def verification(self) -> Verification:
        """What was found so far."""
        return Verification(
            self.beliefs,
            self.steps,
            self.value,
            self.belief,
            self.agreed / self.decisions if self.decisions else 1.0,
            self.seconds["joint"],
            self.seconds["decomposed"],
            self.first,
        )

    def _timed(self, which: str) -> _Stopwatch:
        return _Stopwatch(self.seconds, which)

    def _note_value(
        self, joint: float, ours: float, product: ProductBelief, action: Mapping[str, Value], where: str
    ) -> None:
        self.value = max(self.value, abs(joint - ours))
        if abs(joint - ours) > TOLERANCE * max(1.0, abs(joint)):
            self._note("value", where, product, action, None, "", joint, ours)

    def _note(
        self,
        what: str,
        where: str,
        product: ProductBelief,
        action: Mapping[str, Value],
        observation: Mapping[str, Value] | None,
        at: str,
        joint: float,
        decomposed: float,
    ) -> None:
        if self.first is None:
            belief = spelled_out(product)
            self.first = Difference(what, where, belief, dict(action), observation, at, joint, decomposed)


@dataclass(frozen=True)
class _Stopwatch:
    seconds: dict[str, float]
    which: str
    started: list[float] = field(default_factory=list)

    def __enter__(self) -> None:
        self.started.append(time.perf_counter())

    def __exit__(self, *_: object) -> None:
        self.seconds[self.which] += time.perf_counter() - self.started.pop()
