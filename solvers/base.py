"""What every solver says: whether it can take a model, and what it decided."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from factored_pomdp.variables import Value

__all__ = ["Ability", "Decision"]


@dataclass(frozen=True)
class Ability:
    """Whether a solver can take a model.

    Attributes
    ----------
    can : bool
    because : str
        The part of the model that allows or forbids it.
    estimate : str
        Cost, told before anything is allocated.
    """

    can: bool
    because: str
    estimate: str

    def __bool__(self) -> bool:
        return self.can


@dataclass(frozen=True)
class Decision:
    """A chosen action, with the proof of its quality.

    Attributes
    ----------
    action : dict
        A value for every action variable.
    value : float
        What the action is worth.
    upper_bound : float
        No action is worth more.
    method : str
        How it was found; says "not proved" where ``upper_bound`` lies above ``value``.
    """

    action: Mapping[str, Value]
    value: float
    upper_bound: float
    method: str

    @property
    def gap(self) -> float:
        """How much better another action could be at the most."""
        return max(0.0, self.upper_bound - self.value)

    @property
    def proved(self) -> bool:
        """Whether no action can be better by more than rounding."""
        return self.gap <= 1e-9 * max(1.0, abs(self.value))
