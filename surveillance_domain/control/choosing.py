"""The choice of presets that P, MP, MSP and the full-information bound share: one step ahead, from a belief.

A camera without a view (unavailable, or still turning) is left out: it keeps the preset that it was last sent to and is
not counted on (model.md, "Known variables and actual views"). One that people have is counted on where it looks, at a
preset of its own or not, for it will get no command. The others choose among the presets that they reach.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.factors import DenseFactor, ExpectedNoisyOr, Factor, constant
from factored_pomdp.variables import Value, Variable
from solvers.action_values import Valued, summed_values
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

    def choose(
        self,
        belief: ProductBelief,
        held: Collection[str] = frozenset(),
        missed: Float[np.ndarray, " cells"] | None = None,
    ) -> Choice:
        """The best presets for a belief, whose known values say where the cameras are (``None``: away).

        Parameters
        ----------
        held : collection of str
            Cameras that stay where they are.
        missed : (cells,) float, optional
            Probability that cameras which look at no preset of their own miss a target.
        """
        decision = self._problem(belief, held, missed).solved()
        self.sent |= {move.removesuffix(".move"): str(preset) for move, preset in decision.action.items()}
        return Choice(dict(self.sent), decision.value, decision.upper_bound, decision.method)

    def values(
        self,
        belief: ProductBelief,
        held: Collection[str] = frozenset(),
        missed: Float[np.ndarray, " cells"] | None = None,
    ) -> Valued:
        """What each joint choice of the cameras that are counted on is worth; their moves by the model's names."""
        problem = self._problem(belief, held, missed)
        return summed_values(problem.functions, problem.actions, problem.legal, problem.solved().action)

    def _problem(
        self, belief: ProductBelief, held: Collection[str], missed: Float[np.ndarray, " cells"] | None
    ) -> _Problem:
        views = {camera: belief.known[f"{camera}.preset"] for camera in self.sent}
        present = {f"{camera}.move": str(view) for camera, view in views.items() if view is not None}
        away = {f"{camera}.move": None for camera, view in views.items() if view is None}
        functions = self._solver.local_functions(belief)
        if away:
            functions = [function.condition(away) for function in functions]
        if missed is not None:
            functions = [part for function in functions for part in _beside(function, missed)]
        actions = [move for move in self._model.actions if move.name in present]
        return _Problem(functions, actions, [*self._reachable(present), *_kept(actions, present, held)], present)

    def _reachable(self, present: dict[str, str]) -> list[Factor]:
        legal = self._model.legal
        return [
            legal[move].condition({f"{move.removesuffix('.move')}.preset": view})
            for move, view in present.items()
            if move in legal
        ]


@dataclass(frozen=True, eq=False)
class _Problem:
    """Local functions of moves, the moves, what is legal, and what to keep where that costs nothing."""

    functions: list[Factor]
    actions: list[Variable]
    legal: list[Factor]
    prefer: dict[str, str]

    def solved(self) -> Decision:
        prefer: dict[str, Value] = dict(self.prefer)
        return maximise(self.functions, self.actions, self.legal, prefer)


def _beside(function: Factor, missed: Float[np.ndarray, " cells"]) -> list[Factor]:
    """What choices add to what cameras that get no command see anyway, and the latter: Σ w (1 − (1 − p) ∏ (1 − pᵢ))."""
    if not isinstance(function, ExpectedNoisyOr):
        raise TypeError(f"a local function of places was expected, not {type(function).__name__}")
    left = np.pad(missed, (0, len(function.weights) - len(missed)), constant_values=1.0)
    seen = float((function.weights * (1 - left)).sum())
    return [function.with_weights(function.weights * left), constant(seen)]


def _kept(actions: list[Variable], present: dict[str, str], held: Collection[str]) -> list[Factor]:
    """Moves of held cameras may only be to where they look."""
    return [
        DenseFactor([move], np.array([float(value == present[move.name]) for value in move.values]))
        for move in actions
        if move.name.removesuffix(".move") in held
    ]
