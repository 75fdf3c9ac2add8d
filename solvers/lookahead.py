"""Policy rollout on factored beliefs: what follows each first action if the myopic policy goes on from there.

For every first action the myopic policy is followed for the rest of the horizon in simulated worlds, whose hidden
states are drawn from the belief. The action with the largest mean discounted return is one step of policy improvement
on the myopic policy. Source: Tesauro and Galperin, "On-line policy improvement using Monte-Carlo search", NIPS 1996;
Bertsekas and Castañón, "Rollout algorithms for stochastic scheduling problems", Journal of Heuristics 5 (1999).

Three things keep the noise small. All first actions meet the same chances (common random numbers), so that differences
count and not values. A step counts with its expected reward at the belief, not with what the world happens to pay
(tower property). Scenarios come in batches, after each of which the actions that are surely behind are dropped (a race:
Maron and Moore, "Hoeffding races", NIPS 1993, here by the standard error of paired differences).

Time of a decision: at most actions × scenarios × (horizon − 1) steps of the belief, each with a one-step choice.
Memory: a belief for each action and scenario of a batch. When not to use it: where the flat tables fit, as
`point-based` then gives proved bounds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.model import FactoredPOMDP
from solvers.base import Ability
from solvers.foresight.first_actions import FirstAction
from solvers.foresight.online import Online, can_look_ahead
from solvers.foresight.returns import Returns

__all__ = ["Lookahead"]

_HORIZON, _SCENARIOS, _ACTIONS = 5, 32, 8
_BATCH = 8
_SURELY = 2.0


class Lookahead(Online):
    """One step of policy improvement on the myopic policy, by simulation.

    Parameters
    ----------
    model : FactoredPOMDP
    horizon : int
        Steps that count, the next one included; with 1 the choice is the myopic one.
    scenarios : int
        Simulated worlds for each first action, at most.
    actions : int
        First actions that are compared, at most.
    margin : float
        By how many standard errors another action must lead the myopic one.
    keep : mapping, optional
        Action variables to known variables whose present value the myopic policy keeps where that costs nothing.
    rng : Generator, optional
        Of the simulated worlds; one of seed 0 if left out.
    """

    name = "lookahead"
    summary = "several steps ahead by simulation, the myopic policy following each first action"

    def __init__(
        self,
        model: FactoredPOMDP,
        horizon: int = _HORIZON,
        scenarios: int = _SCENARIOS,
        actions: int = _ACTIONS,
        margin: float = 1.0,
        keep: Mapping[str, str] | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        super().__init__(model, horizon, scenarios, actions, margin, keep, rng)

    @classmethod
    def can_solve(cls, model: FactoredPOMDP) -> Ability:
        actions = min(_ACTIONS, model.joint_actions)
        return can_look_ahead(model, actions * _SCENARIOS * (_HORIZON - 1), actions * _BATCH)

    def compared(self, belief: ProductBelief) -> Returns:
        """Returns of the first actions that stay in the race, the myopic action first."""
        found = self.returns(belief, self.first_actions(belief), min(_BATCH, self.scenarios))
        while found.scenarios < self.scenarios and len(found.actions) > 1:
            found = found.of(found.contenders(_SURELY))
            more = min(_BATCH, self.scenarios - found.scenarios)
            found = found.and_more(self.returns(belief, found.actions, more))
        return found

    def returns(self, belief: ProductBelief, actions: Sequence[FirstAction], scenarios: int) -> Returns:
        """Discounted returns over the horizon of some first actions, each followed by the myopic policy.

        Parameters
        ----------
        actions : sequence of (action, expected reward of the next step)
        scenarios : int
            All of the actions in each.
        """
        simulated, copies = self._simulated, len(actions)
        run, totals = simulated.begun(belief, actions, scenarios, self._rng)
        chances = np.tile(simulated.chances(self.steps - 1, scenarios, self._rng), (1, 1, copies))
        chosen, weight = simulated.repeated(actions, scenarios), 1.0
        for luck in chances:
            run = simulated.stepped(run, chosen, luck)
            weight *= self.model.discount
            values, chosen = simulated.chosen(run.crowd)
            totals[run.numbers] += weight * values
        return Returns(tuple(actions), totals.reshape(copies, scenarios).T)

    def _described(self, found: Returns) -> str:
        return f"rollout over {self.steps} steps in {found.scenarios} scenarios"
