"""Choosing presets for several steps: P's choice, unless another proves better in simulation (`solvers.lookahead`).

It pays where cameras are slow: which presets are in reach later depends on what is chosen now (model.md, "Slew"). Where
every preset is reachable in one step, only what is learned for later is left to be gained.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import ProductBelief, initial_belief
from solvers.lookahead import Lookahead
from surveillance_domain.control.base import Choice
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.model.build import Surveillance

__all__ = ["LookaheadChooser"]


class LookaheadChooser:
    """Maximises the expected number of targets observed over several steps, P's choice following the first one.

    While a camera is away, or people have it, the choice is P's: for how many steps is not known. So it is while
    targets have come or gone: it simulates those of the model.

    Parameters
    ----------
    horizon : int
        Steps that count, the next one included.
    scenarios, actions, margin
        Of `solvers.lookahead.Lookahead`.
    rng : Generator, optional
        Of the simulated worlds; one of seed 0 if left out.
    """

    def __init__(
        self,
        surveillance: Surveillance,
        horizon: int = 5,
        scenarios: int = 32,
        actions: int = 12,
        margin: float = 1.0,
        rng: np.random.Generator | None = None,
    ) -> None:
        self._one_step = PresetChooser(surveillance)
        keep = {f"{camera.name}.move": f"{camera.name}.preset" for camera in surveillance.site.cameras}
        self._blocks = initial_belief(surveillance.model).blocks
        self._solver = Lookahead(surveillance.model, horizon, scenarios, actions, margin, keep, rng)

    @property
    def moves(self) -> dict[str, str]:
        """The last choice as a joint action of the model."""
        return self._one_step.moves

    def choose(
        self,
        belief: ProductBelief,
        held: Collection[str] = frozenset(),
        missed: Float[np.ndarray, " cells"] | None = None,
    ) -> Choice:
        """Presets for the next step; value and upper bound are those of that step alone, as P's are."""
        one_step = self._one_step.choose(belief, held, missed)
        if held or None in belief.known.values() or belief.blocks != self._blocks:
            return one_step
        decision = self._solver.decide(belief)
        for move, preset in decision.action.items():
            self._one_step.sent[move.removesuffix(".move")] = str(preset)
        value = self._solver.base.value(belief, decision.action)
        return Choice(dict(self._one_step.sent), value, one_step.upper_bound, decision.method)
