"""P, the paper's controller: one step ahead over the factored belief (eq:policy1, eq:policy3)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from functools import partial
from typing import Any, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import ProductBelief, initial_belief
from factored_pomdp.variables import Value
from surveillance_domain.control.base import Choice
from surveillance_domain.control.beyond import BeyondViews
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.control.restart import TargetRestart
from surveillance_domain.control.roster import OpenRoster, target_of, targets_of
from surveillance_domain.model.build import UNSEEN, Surveillance
from surveillance_domain.model.elsewhere import Elsewhere, Place
from surveillance_domain.world.base import Cell, Sighting

__all__ = ["Chooser", "PomdpController"]


@runtime_checkable
class Chooser(Protocol):
    """Chooses presets for a belief."""

    @property
    def moves(self) -> dict[str, str]:
        """The last choice as a joint action of the model."""

    def choose(
        self,
        belief: ProductBelief,
        held: Collection[str] = frozenset(),
        missed: Float[np.ndarray, " cells"] | None = None,
    ) -> Choice:
        """Presets for the next step, in which held cameras stay where they are.

        ``missed`` is the probability that cameras at no preset of their own miss a target.
        """


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
    elsewhere : dict
        Where those of them look that stand at no preset of their own.
    """

    def __init__(
        self, surveillance: Surveillance, chooser: Chooser | None = None, roster: OpenRoster | None = None
    ) -> None:
        self.belief = initial_belief(surveillance.model)
        self.restarts, self.restarted = 0, tuple[str, ...]()
        self.roster, self.held, self.elsewhere = roster, frozenset[str](), dict[str, Place]()
        self._chooser = chooser if chooser is not None else PresetChooser(surveillance)
        self._restart, self._beyond = TargetRestart(surveillance), BeyondViews(surveillance)
        self._elsewhere = Elsewhere(surveillance.site)

    @property
    def targets(self) -> tuple[str, ...]:
        """Those in the belief now."""
        return targets_of(self.belief)

    def choose(self) -> Choice:
        return self._chooser.choose(self.belief, self.held, self.missed)

    @property
    def missed(self) -> Float[np.ndarray, " cells"] | None:
        """Probability that the cameras which look at no preset of their own miss a target; ``None``: there are none."""
        return self._elsewhere.missed(self.elsewhere) if self.elsewhere else None

    def see(self, sighting: Sighting) -> None:
        self.restarted, self.held, self.elsewhere = (), sighting.held, dict(sighting.elsewhere)
        seen = {**sighting.observations, **(sighting.unknown if self.roster is not None else {})}
        cells = {target: seen.get(target) for target in self.targets}
        by = {**sighting.beyond, **sighting.through}
        beyond = {target: cell for target, cell in cells.items() if cell is not None and target in by}
        observed = {f"{t}.sighting": UNSEEN if c is None else c for t, c in cells.items() if t not in beyond}
        known: dict[str, Value] = {f"{name}.preset": view for name, view in sighting.views.items()}
        predicted = self.belief.predict(self._chooser.moves)
        weighed, impossible = self._beyond.weighed(predicted, beyond, by)
        known |= {f"{target}.location": cell for target, cell in impossible.items()}
        missed = self.missed
        if missed is not None:
            unseen = [target for target, cell in cells.items() if cell is None]
            weighed = self._beyond.unseen(weighed, unseen, missed)
        self.belief = weighed.condition(observed, known, restart=partial(self._restarted, cells, predicted))
        if self.roster is not None:
            self.belief = self.roster.updated(self.belief, seen, sighting.time_s)

    def _restarted(
        self,
        cells: Mapping[str, Cell | None],
        predicted: ProductBelief,
        block: tuple[str, ...],
        weighed: Any,
        observation: Any,
        known: Any,
    ) -> Any:
        target = target_of(block)
        self.restarts += 1
        self.restarted += (target,)
        before, expected = self.belief.block(block[0]).array, predicted.block(block[0]).array
        return self._restart(cells[target], expected, known, before, self.missed)
