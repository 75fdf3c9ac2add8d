"""P, the paper's controller: one step ahead over the factored belief (eq:policy1, eq:policy3)."""

from __future__ import annotations

from typing import Any, Protocol

from factored_pomdp.beliefs import ProductBelief, initial_belief
from surveillance_domain.control.base import Choice
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.control.restart import TargetRestart
from surveillance_domain.model.build import UNSEEN, Surveillance
from surveillance_domain.world.base import Sighting

__all__ = ["Chooser", "PomdpController"]


class Chooser(Protocol):
    """Chooses presets for a belief."""

    @property
    def moves(self) -> dict[str, str]:
        """The last choice as a joint action of the model."""

    def choose(self, belief: ProductBelief) -> Choice:
        """Presets for the next step."""


class PomdpController:
    """Keeps a product belief and maximises the expected number of targets observed in the next step.

    Parameters
    ----------
    chooser : Chooser, optional
        Chooses in place of P, for the same belief.

    Attributes
    ----------
    belief : ProductBelief
        After the last sighting; known values are the actual views, ``None`` for a camera that is away.
    restarts : int
        Beliefs started anew so far, because the model called the sighting impossible.
    """

    def __init__(self, surveillance: Surveillance, chooser: Chooser | None = None) -> None:
        self.belief = initial_belief(surveillance.model)
        self.restarts = 0
        self._chooser = chooser if chooser is not None else PresetChooser(surveillance)
        self._restart = TargetRestart(surveillance)

    def choose(self) -> Choice:
        return self._chooser.choose(self.belief)

    def see(self, sighting: Sighting) -> None:
        observed = {f"{t}.sighting": UNSEEN if cell is None else cell for t, cell in sighting.observations.items()}
        known = {f"{name}.preset": view for name, view in sighting.views.items()}
        predicted = self.belief.predict(self._chooser.moves)
        self.belief = predicted.condition(observed, known, restart=self._restarted)

    def _restarted(self, block: tuple[str, ...], predicted: Any, observation: Any, known: Any) -> Any:
        self.restarts += 1
        return self._restart(block, predicted, observation, known, self.belief.block(block[0]).array)
