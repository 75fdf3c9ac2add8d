"""Sparse sampling on factored beliefs: a tree of a few sampled observations under each of a few actions.

``Q_d(B, a) = V(B, a) + γ / w Σ max_a' Q_{d−1}(B', a')`` over w sampled posteriors B'; at depth 1 the myopic value. The
cost does not depend on how many states or observations there are. Source: Kearns, Mansour and Ng, "A sparse sampling
algorithm for near-optimal planning in large Markov decision processes", Machine Learning 49 (2002). All actions at a
belief meet the same chances. The maximum over noisy estimates is too large on average, so a value is no lower bound.
With depth 2 it is the rollout of `solvers.lookahead` over two steps.
Time of a decision: (actions × width)^(depth − 1) steps of the belief. When not to use it: for many steps.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.model import FactoredPOMDP
from solvers.base import Ability
from solvers.foresight.online import Online, can_look_ahead
from solvers.foresight.returns import Returns
from solvers.foresight.scenarios import Run

__all__ = ["SparseSampling"]

_DEPTH, _WIDTH, _ACTIONS = 3, 8, 4


class SparseSampling(Online):
    """Looks at every sequence of a few actions, each with a few sampled observations.

    Parameters
    ----------
    model : FactoredPOMDP
    depth : int
        Steps that count, the next one included; with 1 the choice is the myopic one.
    width : int
        Sampled observations for each belief and action.
    actions : int
        Actions that are compared at each belief but those of the last step.
    margin : float
        By how many standard errors another action must lead the myopic one.
    keep : mapping, optional
        Action variables to known variables whose present value the myopic policy keeps where that costs nothing.
    rng : Generator, optional
        Of the observations; one of seed 0 if left out.
    """

    name = "sparse-sampling"
    summary = "a few steps ahead, over a tree of sampled observations"

    def __init__(
        self,
        model: FactoredPOMDP,
        depth: int = _DEPTH,
        width: int = _WIDTH,
        actions: int = _ACTIONS,
        margin: float = 1.0,
        keep: Mapping[str, str] | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        super().__init__(model, depth, width, actions, margin, keep, rng)

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        branches = min(_ACTIONS, model.joint_actions) * _WIDTH
        return can_look_ahead(model, sum(branches**level for level in range(1, _DEPTH)), branches)

    def compared(self, belief: ProductBelief) -> Returns:
        """Returns of the first actions with the best sampled continuation of each."""
        return self._tree(belief, self.steps)

    def _tree(self, belief: ProductBelief, depth: int) -> Returns:
        simulated, actions = self._simulated, self.first_actions(belief)
        run, totals = simulated.begun(belief, actions, self.scenarios, self._rng)
        luck = np.tile(simulated.chances(1, self.scenarios, self._rng)[0], len(actions))
        run = simulated.stepped(run, simulated.repeated(actions, self.scenarios), luck)
        totals[run.numbers] += self.model.discount * self._worth(run, depth - 1)
        return Returns(tuple(actions), totals.reshape(len(actions), self.scenarios).T)

    def _worth(self, run: Run, depth: int) -> np.ndarray:
        """The best value of each belief with so many steps to go."""
        if depth == 1:
            return self._simulated.chosen(run.crowd).values
        trees = (self._tree(run.crowd.belief(number), depth) for number in range(len(run.numbers)))
        return np.array([found.mean(found.best) for found in trees])

    def _described(self, found: Returns) -> str:
        return f"sparse sampling of depth {self.steps} and width {self.scenarios}"
