"""Targets that come and go: one that was never met before starts a belief, one that is gone for long ends it.

A target that the site names is always there. Every other one, and every marker that nobody knows, is there from its
first sighting until it has not been seen for the site's ``forget_s`` seconds.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from factored_pomdp.beliefs import ProductBelief, initial_belief
from surveillance_domain.control.restart import TargetRestart
from surveillance_domain.model.build import Surveillance
from surveillance_domain.world.base import Cell

__all__ = ["OpenRoster", "target_of", "targets_of"]

_PARTS = ("location", "direction", "speed", "sighting")


def target_of(block: Sequence[str]) -> str:
    """The target whose variables a block holds."""
    return block[0].rpartition(".")[0]


def targets_of(belief: ProductBelief) -> tuple[str, ...]:
    """The targets in a belief."""
    return tuple(target_of(block) for block in belief.blocks)


class OpenRoster:
    """Adds targets to a belief and takes them out.

    Attributes
    ----------
    started, ended : int
        How many were, so far.
    """

    def __init__(self, surveillance: Surveillance) -> None:
        self.started = self.ended = 0
        self._named = frozenset(target.name for target in surveillance.site.targets.known)
        self._forget_s = surveillance.site.operation.forget_s
        self._prior = TargetRestart(surveillance)
        self._model = initial_belief(surveillance.model)
        self._last_seen_s: dict[str, float] = {}

    def updated(self, belief: ProductBelief, seen: Mapping[str, Cell | None], time_s: float) -> ProductBelief:
        """The belief after a sighting, of whom there is now.

        Parameters
        ----------
        belief : ProductBelief
            Conditioned on the sighting already.
        seen : mapping
            Where targets, known or not, were seen.
        time_s : float
            Of the sighting.
        """
        present = targets_of(belief)
        for name, cell in seen.items():
            if cell is not None:
                self._last_seen_s[name] = time_s
                if name not in present:
                    belief = self._with(belief, name, cell)
                    self.started += 1
        for name in present:
            if name not in self._named and time_s - self._last_seen_s.setdefault(name, time_s) > self._forget_s:
                belief = belief.without_block(f"{name}.location")
                del self._last_seen_s[name]
                self.ended += 1
        return belief

    def _with(self, belief: ProductBelief, name: str, cell: Cell) -> ProductBelief:
        """One more target, seen at a cell: it may have come there in every direction that leads there."""
        like = belief if belief.blocks else self._model
        first = targets_of(like)[0]
        grown = like.with_block({f"{first}.{part}": f"{name}.{part}" for part in _PARTS}, self._prior.seen_at(cell))
        for other in targets_of(like) if not belief.blocks else ():
            grown = grown.without_block(f"{other}.location")
        return grown.with_arrays(grown.arrays, known=belief.known)
