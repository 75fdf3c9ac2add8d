"""P, the paper's controller: one step ahead over the factored belief (eq:policy1, eq:policy3)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from typing import Any, Protocol, runtime_checkable

from factored_pomdp.beliefs import ProductBelief, initial_belief
from factored_pomdp.variables import Value
from surveillance_domain.control.base import Choice
from surveillance_domain.control.beyond import BeyondViews
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.control.restart import TargetRestart
from surveillance_domain.control.roster import OpenRoster, target_of, targets_of
from surveillance_domain.model.build import UNSEEN, Surveillance
from surveillance_domain.world.base import Cell, Sighting

__all__ = ["Chooser", "PomdpController"]


@runtime_checkable
class Chooser(Protocol):
    """Chooses presets for a belief."""

    @property
    def moves(self) -> dict[str, str]:
        """The last choice as a joint action of the model."""

    def choose(self, belief: ProductBelief, held: Collection[str] = frozenset()) -> Choice:
        """Presets for the next step, in which held cameras stay where they are."""


class PomdpController:
    """Keeps a product belief and maximises the expected number of targets observed in the next step.

    Parameters
    ----------
    chooser : Chooser, optional
        Chooses in place of P, for the same belief.
    roster : OpenRoster, optional
        Lets targets come and go; without it, what the model does not know is passed over.

    Attributes
    ----------
    belief : ProductBelief
        After the last sighting; known values are the actual views, ``None`` for a camera that is away.
    restarts : int
        Beliefs started anew so far, because the model called the sighting impossible.
    restarted : tuple of str
        Targets whose beliefs were, in the last step.
    roster : OpenRoster or None
    held : frozenset of str
        Cameras that people have.
    """

    def __init__(
        self, surveillance: Surveillance, chooser: Chooser | None = None, roster: OpenRoster | None = None
    ) -> None:
        self.belief = initial_belief(surveillance.model)
        self.restarts, self.restarted = 0, tuple[str, ...]()
        self.roster, self.held = roster, frozenset[str]()
        self._chooser = chooser if chooser is not None else PresetChooser(surveillance)
        self._restart, self._beyond = TargetRestart(surveillance), BeyondViews(surveillance)

    @property
    def targets(self) -> tuple[str, ...]:
        """Those in the belief now."""
        return targets_of(self.belief)

    def choose(self) -> Choice:
        return self._chooser.choose(self.belief, self.held)

    def see(self, sighting: Sighting) -> None:
        self.restarted, self.held = (), sighting.held
        seen = {**sighting.observations, **(sighting.unknown if self.roster is not None else {})}
        cells = {target: seen.get(target) for target in self.targets}
        beyond = {target: cell for target, cell in cells.items() if cell is not None and target in sighting.beyond}
        observed = {f"{t}.sighting": UNSEEN if c is None else c for t, c in cells.items() if t not in beyond}
        known: dict[str, Value] = {f"{name}.preset": view for name, view in sighting.views.items()}
        predicted = self.belief.predict(self._chooser.moves)
        weighed, impossible = self._beyond.weighed(predicted, beyond, sighting.beyond)
        known |= {f"{target}.location": cell for target, cell in impossible.items()}
        self.belief = weighed.condition(observed, known, restart=partial(self._restarted, cells))
        if self.roster is not None:
            self.belief = self.roster.updated(self.belief, seen, sighting.time_s)

    def _restarted(
        self, cells: Mapping[str, Cell | None], block: tuple[str, ...], predicted: Any, observation: Any, known: Any
    ) -> Any:
        target = target_of(block)
        self.restarts += 1
        self.restarted += (target,)
        return self._restart(cells[target], predicted, known, self.belief.block(block[0]).array)
