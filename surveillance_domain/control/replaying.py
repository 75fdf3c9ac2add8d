"""A recorded watch, gone through again: sightings as they were, and the belief that follows from them.

Beliefs are not in the record. They follow from the sightings, and the prediction of a target does not depend on what
cameras were sent to, so the filter alone is run again; exactly, if the record is there from its run's first step on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from factored_pomdp.beliefs import ProductBelief
from solvers.action_values import Valued
from surveillance_domain.control.choosing import PresetChooser
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.roster import OpenRoster
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.world.base import Cell, Sighting

__all__ = ["Refilter", "sighting_of"]


def sighting_of(entry: Mapping[str, Any]) -> Sighting:
    """The sighting of a recorded step."""
    return Sighting(
        {target: _cell(cell) for target, cell in entry["observations"].items()},
        dict(entry["views"]),
        float(entry["time_s"]),
        held=frozenset(entry["held"]),
        unknown={name: (int(cell[0]), int(cell[1])) for name, cell in entry["unknown"].items()},
        without_identity=int(entry["without_identity"]),
        out_of_view=int(entry["out_of_view"]),
        beyond=dict(entry.get("beyond", {})),  # older records have none, nor the next
        through=dict(entry.get("through", {})),
        elsewhere={name: (place[0], place[1], place[2]) for name, place in entry.get("elsewhere", {}).items()},
    )


class Refilter:
    """The belief along a record.

    Parameters
    ----------
    surveillance : Surveillance
        With the targets that the record's header names.
    """

    def __init__(self, surveillance: Surveillance) -> None:
        self._controller = PomdpController(surveillance, roster=OpenRoster(surveillance))
        self._chooser = PresetChooser(surveillance)

    @property
    def belief(self) -> ProductBelief:
        """After the last sighting that was taken."""
        return self._controller.belief

    @property
    def targets(self) -> tuple[str, ...]:
        """Those that there were then."""
        return self._controller.targets

    @property
    def elsewhere(self) -> Mapping[str, Place]:
        """Where those cameras looked then that were at no preset of their own."""
        return self._controller.elsewhere

    def values(self) -> Valued:
        """What each choice for the next step was worth, by P's reckoning; cameras that were away left out."""
        return self._chooser.values(self._controller.belief, self._controller.held, self._controller.missed)

    def take(self, entry: Mapping[str, Any]) -> None:
        """One more step of the record."""
        self._controller.see(sighting_of(entry))


def _cell(cell: Sequence[int] | None) -> Cell | None:
    return None if cell is None else (int(cell[0]), int(cell[1]))
