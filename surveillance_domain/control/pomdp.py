"""P, the paper's controller: one step ahead over the factored belief (eq:policy1, eq:policy3)."""

from __future__ import annotations

from typing import Any

from factored_pomdp.beliefs import initial_belief
from solvers.myopic import DecomposedMyopic
from surveillance_domain.control.base import Choice
from surveillance_domain.control.restart import TargetRestart
from surveillance_domain.model.build import UNSEEN, Surveillance
from surveillance_domain.world.base import Sighting

__all__ = ["PomdpController"]


class PomdpController:
    """Keeps a product belief and maximises the expected number of targets observed in the next step."""

    def __init__(self, surveillance: Surveillance) -> None:
        self.belief = initial_belief(surveillance.model)
        self.restarts = 0
        self._solver = DecomposedMyopic(surveillance.model)
        self._cameras = tuple(camera.name for camera in surveillance.site.cameras)
        self._restart = TargetRestart(surveillance)
        self._moves: dict[str, str] = {}

    def choose(self) -> Choice:
        present = {f"{name}.move": self.belief.known[f"{name}.preset"] for name in self._cameras}
        decision = self._solver.decide(self.belief, prefer=present)
        self._moves = {name: str(value) for name, value in decision.action.items()}
        presets = {name: self._moves[f"{name}.move"] for name in self._cameras}
        return Choice(presets, decision.value, decision.upper_bound, decision.method)

    def see(self, sighting: Sighting) -> None:
        observed = {f"{t}.sighting": UNSEEN if cell is None else cell for t, cell in sighting.observations.items()}
        known = {f"{name}.preset": view for name, view in sighting.views.items()}
        predicted = self.belief.predict(self._moves)
        self.belief = predicted.condition(observed, known, restart=self._restarted)

    def _restarted(self, block: tuple[str, ...], predicted: Any, observation: Any, known: Any) -> Any:
        self.restarts += 1
        return self._restart(block, predicted, observation, known, self.belief.block(block[0]).array)
