"""Sampled returns of several first actions in common scenarios, compared by their paired differences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from solvers.action_values import Valued
from solvers.foresight.first_actions import FirstAction

__all__ = ["Returns"]

_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Returns:
    """Discounted returns.

    Attributes
    ----------
    actions : tuple of FirstAction
        With their expected rewards of the next step; the base policy's action first.
    samples : (scenarios, actions) float
    dropped : tuple of (action, float)
        What was estimated of actions that are not followed any more.
    """

    actions: tuple[FirstAction, ...]
    samples: Float[np.ndarray, "scenarios actions"]
    dropped: tuple[FirstAction, ...] = ()

    @property
    def scenarios(self) -> int:
        return len(self.samples)

    def mean(self, action: int) -> float:
        """Estimated return of an action."""
        return float(self.samples[:, action].mean())

    def error(self, action: int) -> float:
        """Standard error of that."""
        return _standard_error(self.samples[:, action])

    def lead(self, action: int, other: int = 0) -> tuple[float, float]:
        """Mean return of one action minus another's, and the standard error of that (paired by scenario)."""
        difference = self.samples[:, action] - self.samples[:, other]
        return float(difference.mean()), _standard_error(difference)

    @property
    def valued(self) -> Valued:
        """Estimated returns of all the actions, those that were dropped last."""
        return [(action, self.mean(number)) for number, (action, _) in enumerate(self.actions)] + list(self.dropped)

    @property
    def best(self) -> int:
        """The action with the largest mean; the first of equals."""
        means = self.samples.mean(axis=0)
        return int(np.flatnonzero(means >= means.max() - _ROUNDING)[0])

    def better_than_base(self, margin: float) -> int:
        """The best action if it leads the base by more than ``margin`` standard errors, else the base (0)."""
        lead, error = self.lead(self.best)
        return self.best if lead > max(margin * error, _ROUNDING) else 0

    def contenders(self, errors: float) -> list[int]:
        """The base, and every action that is not behind the best by more than so many standard errors."""
        kept = [0]
        for action in range(1, len(self.actions)):
            lead, error = self.lead(action, self.best)
            if lead >= -errors * error - _ROUNDING:
                kept.append(action)
        return kept

    def of(self, actions: Sequence[int]) -> Returns:
        """Some of the actions; the others are dropped."""
        others = [action for action in range(len(self.actions)) if action not in actions]
        dropped = self.dropped + tuple((self.actions[action][0], self.mean(action)) for action in others)
        return Returns(tuple(self.actions[action] for action in actions), self.samples[:, list(actions)], dropped)

    def and_more(self, other: Returns) -> Returns:
        """The same actions in more scenarios."""
        return Returns(self.actions, np.concatenate([self.samples, other.samples]), self.dropped)


def _standard_error(samples: Float[np.ndarray, " scenarios"]) -> float:
    return float(samples.std(ddof=1)) / math.sqrt(len(samples)) if len(samples) > 1 else math.inf
