"""Many imagined runs of a model at once: simulated worlds, what is believed in each, and the myopic choice there.

Observations are drawn from the hidden state that a world really is in, so a scenario is a run of the model as the
agent's own belief foresees it. The myopic choice is made for all scenarios together where its tables are small
(`solvers.foresight.one_step_tables`), else scenario by scenario; equals are broken as `solvers.maximise` breaks them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from factored_pomdp.beliefs import ProductBelief
from factored_pomdp.beliefs.plan import plan_of
from solvers.foresight.crowd import Crowd
from solvers.foresight.first_actions import FirstAction
from solvers.foresight.one_step_tables import OneStepTables, tables_fit
from solvers.foresight.worlds import Places, Worlds
from solvers.myopic import DecomposedMyopic

__all__ = ["Choices", "Run", "Scenarios"]

_TIE = 1e-10


@dataclass(frozen=True, eq=False)
class Run:
    """Where those runs stand whose episodes are not over.

    Attributes
    ----------
    states : dict of (runs,) int
        What the worlds are in.
    crowd : Crowd
        What is believed there.
    numbers : (runs,) int
        Which of those that were begun these are.
    """

    states: Places
    crowd: Crowd
    numbers: Int[np.ndarray, " runs"]


class Choices(NamedTuple):
    """The myopic choice in each scenario: its value, and the positions of the action variables' values."""

    values: np.ndarray
    actions: dict[str, np.ndarray]


class Scenarios:
    """Imagined runs.

    Parameters
    ----------
    myopic : DecomposedMyopic
    keep : mapping
        Action variables to known variables whose present value is kept where that costs nothing.
    tables : bool
        Whether to choose by tables where they are small enough.
    """

    def __init__(self, myopic: DecomposedMyopic, keep: Mapping[str, str], tables: bool = True) -> None:
        self.model, self._myopic, self._keep = myopic.model, myopic, dict(keep)
        self._worlds = Worlds(myopic.model)
        self._known = plan_of(myopic.model).structure.known
        self._tables = OneStepTables(myopic) if tables and tables_fit(myopic.model) else None

    def chances(self, steps: int, scenarios: int, rng: np.random.Generator) -> Float[np.ndarray, "steps numbers _"]:
        """The random numbers of some steps; scenarios that are given the same ones meet the same chances."""
        return rng.random((steps, self._worlds.numbers, scenarios))

    def begun(
        self, belief: ProductBelief, actions: Sequence[FirstAction], scenarios: int, rng: np.random.Generator
    ) -> tuple[Run, Float[np.ndarray, " runs"]]:
        """Runs from a belief and what their first step earns: every first action in the same scenarios.

        The hidden states of the scenarios are drawn from the belief; runs are numbered action by action.
        """
        drawn, copies = self._worlds.drawn(belief, scenarios, rng), len(actions)
        states = {name: np.tile(places, copies) for name, places in drawn.items()}
        run = Run(states, Crowd.of(belief, scenarios * copies), np.arange(scenarios * copies))
        return run, np.repeat(np.array([value for _, value in actions]), scenarios)

    def repeated(self, actions: Sequence[FirstAction], scenarios: int) -> dict[str, np.ndarray]:
        """The first actions of runs as `begun` numbers them."""
        places = {v.name: [v.index(action[v.name]) for action, _ in actions] for v in self.model.actions}
        return {name: np.repeat(place, scenarios) for name, place in places.items()}

    def stepped(self, run: Run, actions: Places, chances: Float[np.ndarray, "numbers _"]) -> Run:
        """The runs that go on after an action in each.

        Parameters
        ----------
        chances : (numbers, runs that were begun) float
        """
        if not len(run.numbers):
            return run
        after, seen = self._worlds.step(run.states, actions, chances[:, run.numbers])
        going = self._goes_on(after, len(run.numbers))
        states, seen, actions = ({n: p[going] for n, p in places.items()} for places in (after, seen, actions))
        known = {name: states[name] for name in self._known}
        return Run(states, run.crowd.some(going).after(actions, known, seen), run.numbers[going])

    def chosen(self, crowd: Crowd) -> Choices:
        """The myopic choice in every scenario; there may be none left."""
        if not crowd.scenarios:
            return Choices(np.zeros(0), {variable.name: np.zeros(0, dtype=int) for variable in self.model.actions})
        return self._one_by_one(crowd) if self._tables is None else self._by_tables(crowd, self._tables)

    def preferred(self, belief: ProductBelief) -> dict[str, object]:
        """Action values that the myopic policy keeps at a belief where that costs nothing."""
        return {action: belief.known[name] for action, name in self._keep.items() if belief.known[name] is not None}

    def _by_tables(self, crowd: Crowd, tables: OneStepTables) -> Choices:
        shape = [variable.size for variable in self.model.actions]
        places = np.indices(shape).reshape(len(shape), -1)
        values = np.where(self._legal(crowd, places), tables.values(crowd), -np.inf)
        best = values.max(axis=0)
        kept = np.ones(values.shape)
        for variable, place in zip(self.model.actions, places, strict=True):
            if variable.name in self._keep:
                name = self._keep[variable.name]
                present = [variable.index(v) if v in variable.values else -1 for v in self.model.variable(name).values]
                kept += place[:, None] == np.array(present)[crowd.known[name]]
        number = np.where(values >= best - _TIE * np.maximum(1.0, np.abs(best)), kept, 0).argmax(axis=0)
        actions = {v.name: place[number] for v, place in zip(self.model.actions, places, strict=True)}
        return Choices(values[number, np.arange(crowd.scenarios)], actions)

    def _legal(self, crowd: Crowd, places: np.ndarray) -> Bool[np.ndarray, "actions scenarios"]:
        """Which joint actions may be chosen, by the known values of each scenario."""
        allowed = np.ones((places.shape[1], crowd.scenarios), dtype=bool)
        row = {variable.name: place[:, None] for variable, place in zip(self.model.actions, places, strict=True)}
        for rule in self.model.legal.values():
            at = tuple(row[v.name] if v.name in row else crowd.known[v.name][None, :] for v in rule.scope)
            allowed &= rule.dense().array[at] > 0
        return allowed

    def _one_by_one(self, crowd: Crowd) -> Choices:
        decisions = []
        for scenario in range(crowd.scenarios):
            belief = crowd.belief(scenario)
            decisions.append(self._myopic.decide(belief, self.preferred(belief)))
        actions = {v.name: np.array([v.index(d.action[v.name]) for d in decisions]) for v in self.model.actions}
        return Choices(np.array([decision.value for decision in decisions]), actions)

    def _goes_on(self, states: Places, scenarios: int) -> Bool[np.ndarray, " scenarios"]:
        """Which worlds are not in a terminal state."""
        if self.model.running is None:
            return np.ones(scenarios, dtype=bool)
        table = self.model.running.dense()
        return np.asarray(table.array[tuple(states[name] for name in table.names)] > 0)
