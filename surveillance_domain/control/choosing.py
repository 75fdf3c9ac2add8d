"""The choice of presets that P, MP, MSP and the full-information bound share: one step ahead, from a belief.

A camera without a view (unavailable, or still turning) is left out: it keeps the preset that it was last sent to and is
not counted on (model.md, "Known variables and actual views"). The others choose among the presets that they reach.
"""

from __future__ import annotations

from collections.abc import Mapping

from factored_pomdp.beliefs import ProductBelief
from solvers.base import Decision
from solvers.maximise import maximise
from solvers.myopic import DecomposedMyopic
from surveillance_domain.control.base import Choice
from surveillance_domain.model.build import Surveillance

__all__ = ["PresetChooser"]


class PresetChooser:
    """Maximises the expected number of targets observed in the next step; ties keep the present presets.

    Attributes
    ----------
    sent : dict
        For each camera the preset that it was last sent to (at first: its first one).
    """

    def __init__(self, surveillance: Surveillance) -> None:
        self._model = surveillance.model
        self._solver = DecomposedMyopic(surveillance.model)
        self.sent: dict[str, str] = {camera.name: camera.presets[0].name for camera in surveillance.site.cameras}

    @property
    def moves(self) -> dict[str, str]:
        """The last choice as a joint action of the model."""
        return {f"{camera}.move": preset for camera, preset in self.sent.items()}

    def choose(self, belief: ProductBelief) -> Choice:
        """The best presets for a belief, whose known values say where the cameras are (``None``: away)."""
        views = {camera: belief.known[f"{camera}.preset"] for camera in self.sent}
        present = {camera: str(view) for camera, view in views.items() if view is not None}
        prefer = {f"{camera}.move": view for camera, view in present.items()}
        if len(present) == len(views):
            decision = self._solver.decide(belief, prefer=prefer)
        else:
            decision = self._without_those_away(belief, present, prefer)
        self.sent |= {camera: str(decision.action[f"{camera}.move"]) for camera in present}
        return Choice(dict(self.sent), decision.value, decision.upper_bound, decision.method)

    def _without_those_away(
        self, belief: ProductBelief, present: Mapping[str, str], prefer: Mapping[str, str]
    ) -> Decision:
        away = {f"{camera}.move": None for camera in self.sent if camera not in present}
        functions = [function.condition(away) for function in self._solver.local_functions(belief)]
        actions = [move for move in self._model.actions if move.name in prefer]
        legal = [
            self._model.legal[f"{camera}.move"].condition({f"{camera}.preset": view})
            for camera, view in present.items()
            if f"{camera}.move" in self._model.legal
        ]
        return maximise(functions, actions, legal, prefer)
