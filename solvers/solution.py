"""What a solver is asked and what it answers: limits, progress, bounds and a policy."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from solvers.flat import FlatModel

if TYPE_CHECKING:
    from solvers.policy import VectorPolicy
    from solvers.two_states import TwoStates

__all__ = ["Clock", "Limits", "Progress", "Solution", "Stopwatch"]


@dataclass(frozen=True)
class Progress:
    """Where an anytime solver stands; bounds at the initial belief."""

    lower: float
    upper: float
    vectors: int
    points: int
    seconds: float

    @property
    def gap(self) -> float:
        return self.upper - self.lower


@dataclass(frozen=True)
class Limits:
    """When to stop.

    Attributes
    ----------
    precision : float
        Gap between the bounds that is good enough.
    time_limit : float or None
        Seconds.
    horizon : int or None
        Steps to plan for; ``None`` for ever, which needs a discount below 1.
    progress : callable, optional
        Called with a `Progress` now and then.
    """

    precision: float = 1e-3
    time_limit: float | None = None
    horizon: int | None = None
    progress: Callable[[Progress], None] | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        if not self.precision > 0:
            raise ValueError(f"precision {self.precision}: expected a number above 0")
        if self.time_limit is not None and not self.time_limit > 0:
            raise ValueError(f"time limit {self.time_limit}: expected seconds above 0")
        if self.horizon is not None and self.horizon < 1:
            raise ValueError(f"horizon {self.horizon}: expected at least 1 step")


@dataclass(frozen=True, eq=False)
class Solution:
    """Bounds at the initial belief, and a policy.

    Attributes
    ----------
    lower : float
        What the policy earns at the least (for a policy that follows an upper bound: what the best blind one earns).
    upper : float
        No policy earns more.
    vectors, points : int
        Alpha vectors of the lower bound, and belief points of the upper one.
    stopped : str
        ``solved``, ``precision``, ``time limit``, ``memory`` or ``interrupted``.
    policy : VectorPolicy or None
    notes : tuple of str
        Why this solver, and what else there is to say.
    lower_is : str
        ``proved``, or ``statistical`` for an estimate by simulation.
    """

    solver: str
    lower: float
    upper: float
    seconds: float
    horizon: int | None
    vectors: int
    points: int
    stopped: str
    policy: VectorPolicy | None = field(repr=False)
    notes: tuple[str, ...] = ()
    lower_is: str = "proved"

    @property
    def gap(self) -> float:
        return self.upper - self.lower

    def save(self, path: Path) -> None:
        """Write the policy to a file; ``ValueError`` where there is none."""
        from solvers.policy_files import save_policy

        if self.policy is None:
            raise ValueError(f"{self.solver} made no policy that could be written to {path}")
        save_policy(self.policy, path)

    def two_states(self) -> TwoStates:
        """The value function of a problem with two states, ready to be drawn.

        Raises
        ------
        ValueError
            Where there is no policy, or the states are not two, or can be told apart.
        """
        from solvers.two_states import two_states

        if self.policy is None:
            raise ValueError(f"{self.solver} made no policy that could be drawn")
        return two_states(self.policy)


class Stopwatch:
    """Counts seconds from where it is made."""

    def __init__(self, time_limit: float | None) -> None:
        self._limit, self._start = time_limit, time.perf_counter()

    @property
    def seconds(self) -> float:
        return time.perf_counter() - self._start

    @property
    def is_over(self) -> bool:
        return self._limit is not None and self.seconds >= self._limit

    @property
    def left(self) -> float | None:
        """Seconds that are left; ``None`` without a limit."""
        return None if self._limit is None else max(0.0, self._limit - self.seconds)


class Clock(Stopwatch):
    """A solver's stopwatch; refuses an infinite horizon without discount.

    Raises
    ------
    ValueError
        Where the discount is 1 and no horizon is given.
    """

    def __init__(self, limits: Limits, flat: FlatModel) -> None:
        if limits.horizon is None and flat.discount >= 1:
            raise ValueError(
                f"{flat.model.name} has discount 1: values without a horizon are not finite; give a horizon"
            )
        super().__init__(limits.time_limit)
        self.limits = limits

    def solution(self, policy: VectorPolicy, stopped: str = "solved", notes: tuple[str, ...] = ()) -> Solution:
        """The answer that a policy's own bounds at the initial belief make."""
        lower, upper = policy.bounds(policy.flat.initial)
        vectors, points = sum(len(stage.lower) for stage in policy.stages), policy.points
        return Solution(
            policy.solver, lower, upper, self.seconds, self.limits.horizon, vectors, points, stopped, policy, notes
        )
