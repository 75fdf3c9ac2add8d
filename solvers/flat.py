"""A model as the flat solvers take it: sparse tables over joint states, laid out class by class.

A *class* is a set of joint states that the agent can tell apart from all others, whatever it does and sees: the known
part of a state ("mixed observability": Ong, Png, Hsu, Lee, "Planning under uncertainty for robotic tasks with mixed
observability", IJRR 2010), found here in any model, flat ones too (`solvers.known_classes`). Beliefs and alpha vectors
then live on one class each.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from jaxtyping import Bool, Float, Int

from factored_pomdp.beliefs.plan import plan_of
from factored_pomdp.expansion import estimate, joint
from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.variables import Value, count
from solvers.base import Ability

__all__ = ["FlatModel", "Tables", "can_flatten", "flatten"]

MOST_BYTES = 2_000_000_000
"""What the flat tables may take."""

MOST_PASSES = 200_000_000
"""Pairs of a joint state and an observation that the search for classes may hold."""


class Tables(NamedTuple):
    """What compiled loops read. Row ``a * N + s`` of a table belongs to action a and joint state s.

    Attributes
    ----------
    move_start, move_state, move_chance : arrays
        ``P(s' | s, a)`` as compressed rows.
    seen_start, seen_column, seen_chance : arrays
        ``P(z | s', a)`` as compressed rows.
    reward : (A, N) float
    class_of : (N,) int
        Non-decreasing.
    class_start : (X + 1,) int
        First state of each class.
    legal : (A, N) bool
    discount : float
    columns : int
        Number of observations (with what is read back).
    """

    move_start: np.ndarray
    move_state: np.ndarray
    move_chance: np.ndarray
    seen_start: np.ndarray
    seen_column: np.ndarray
    seen_chance: np.ndarray
    reward: np.ndarray
    class_of: np.ndarray
    class_start: np.ndarray
    legal: np.ndarray
    discount: float
    columns: int


@dataclass(frozen=True, eq=False)
class FlatModel:
    """Sparse tables of a model, with the numbering that they use.

    Attributes
    ----------
    order : (N,) int
        Joint state (row-major over the model's variables) of each row.
    transition, observation : lists of CSR arrays, one an action
        ``P(s' | s)`` (N, N) and ``P(z | s')`` (N, Z), Z being the model's joint observations.
    initial : (N,) float
    tables : Tables
    """

    model: FactoredPOMDP
    order: Int[np.ndarray, " states"]
    actions: list[dict[str, Value]]
    observations: list[dict[str, Value]]
    transition: list[Any]
    observation: list[Any]
    initial: Float[np.ndarray, " states"]
    tables: Tables

    @property
    def discount(self) -> float:
        return self.tables.discount

    @property
    def size(self) -> int:
        return len(self.order)

    @property
    def reward(self) -> Float[np.ndarray, "actions states"]:
        return self.tables.reward

    @cached_property
    def rank(self) -> Int[np.ndarray, " states"]:
        """Row of each joint state."""
        return np.argsort(self.order)

    @cached_property
    def onward(self) -> list[Any]:
        """The transition tables turned to carry a belief forward: ``b' = onward[a] @ b``; no copies."""
        return [matrix.T for matrix in self.transition]

    @cached_property
    def observation_columns(self) -> list[Any]:
        """The observation tables with their columns ready to be taken out."""
        return [matrix.tocsc() for matrix in self.observation]

    @cached_property
    def column(self) -> dict[tuple[Value, ...], int]:
        """Number of a joint observation, by its values."""
        return {tuple(seen.values()): number for number, seen in enumerate(self.observations)}

    @cached_property
    def running(self) -> Bool[np.ndarray, " states"] | None:
        """Which rows are no terminal states; ``None`` where no state is terminal."""
        if self.model.running is None:
            return None
        shape = [variable.size for variable in self.model.states]
        table = np.broadcast_to(self.model.running.array_over(self.model.states), shape)
        return np.asarray(table.ravel()[self.order] > 0)

    def has_value(self, name: str, value: Value) -> Bool[np.ndarray, " states"]:
        """Which rows have a value of one state variable."""
        shape = [variable.size for variable in self.model.states]
        axis = [variable.name for variable in self.model.states].index(name)
        index = np.unravel_index(self.order, shape)[axis]
        return np.asarray(index == self.model.states[axis].index(value))

    def class_at(self, belief: Float[np.ndarray, " states"]) -> int | None:
        """The class that holds all of a belief's mass; ``None`` if there is no such class."""
        support = np.flatnonzero(belief)
        first, last = self.tables.class_of[support[0]], self.tables.class_of[support[-1]]
        return int(first) if first == last else None


_FLAT: WeakKeyDictionary[FactoredPOMDP, FlatModel] = WeakKeyDictionary()


def can_flatten(model: FactoredPOMDP) -> Ability:
    """Whether the flat tables fit; nothing is allocated to find out."""
    sizes = (
        f"{model.joint_states:,} joint states, {model.joint_actions:,} joint actions, "
        f"{model.joint_observations:,} joint observations"
    )
    if model.joint_states * model.joint_actions > MOST_BYTES // 16:
        return Ability(False, f"{sizes}: too many to list", f"more than {MOST_BYTES:,} bytes")
    needed = estimate(model)
    if needed > MOST_BYTES:
        return Ability(False, f"{sizes}: more than {MOST_BYTES:,} bytes of tables", f"{needed:,} bytes")
    return Ability(True, sizes, f"{needed:,} bytes of tables")


def flatten(model: FactoredPOMDP) -> FlatModel:
    """The flat form of a model, kept as long as the model is.

    Raises
    ------
    TooLarge
        Before anything is allocated.
    ValueError
        Where legal actions depend on what the agent cannot tell.
    """
    if model not in _FLAT:
        _FLAT[model] = _flattened(model)
    return _FLAT[model]


def _flattened(model: FactoredPOMDP) -> FlatModel:
    from solvers.known_classes import known_classes

    flat = joint(model, MOST_BYTES)
    read_back = _with_what_is_read_back(model, flat.observation)
    classes = known_classes(flat.transition, read_back, flat.initial)
    order = np.argsort(classes, kind="stable")
    rank = np.argsort(order)
    _, class_of = np.unique(classes[order], return_inverse=True)
    class_start = np.searchsorted(class_of, np.arange(class_of[-1] + 2))
    legal = np.ascontiguousarray(_legal(model, flat.actions)[:, order])
    _check_legal(model, legal, class_of, class_start)
    transition = [_csr(matrix)[order][:, order] for matrix in flat.transition]
    columns = [_csr(matrix)[order] for matrix in read_back]
    reward = np.ascontiguousarray(flat.reward[:, order])
    tables = Tables(
        *_stacked(transition), *_stacked(columns), reward, class_of.astype(np.int64), class_start.astype(np.int64),
        legal, float(flat.discount), int(columns[0].shape[1]),
    )  # fmt: skip
    observation = [_csr(matrix)[order] for matrix in flat.observation]
    return FlatModel(
        model, np.argsort(rank), flat.actions, flat.observations, transition, observation, flat.initial[order], tables
    )


def _csr(matrix: Any) -> Any:
    from scipy import sparse

    found = sparse.csr_array(matrix)
    found.eliminate_zeros()
    found.sort_indices()
    return found


def _stacked(matrices: list[Any]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows of all actions one after the other."""
    offsets = np.cumsum([0, *(matrix.nnz for matrix in matrices)])
    starts = [matrix.indptr[:-1].astype(np.int64) + offset for matrix, offset in zip(matrices, offsets, strict=False)]
    for matrix in matrices:
        matrix.sort_indices()
    return (
        np.concatenate([*starts, offsets[-1:]]),
        np.concatenate([matrix.indices for matrix in matrices]).astype(np.int64),
        np.concatenate([matrix.data for matrix in matrices]).astype(np.float64),
    )


def _with_what_is_read_back(model: FactoredPOMDP, observation: list[Any]) -> list[Any]:
    """Observation tables in which the variables that are read back after a step are observed as well."""
    from scipy import sparse

    known = set(plan_of(model).structure.known) & model.declared_known
    read = [axis for axis, variable in enumerate(model.states) if variable.name in known]
    if not read:
        return observation
    shape = [variable.size for variable in model.states]
    indexes = np.unravel_index(np.arange(model.joint_states), shape)
    sizes = [shape[axis] for axis in read]
    value = np.ravel_multi_index([indexes[axis] for axis in read], sizes)
    size = int(np.prod(sizes))
    entries = [sparse.coo_array(matrix) for matrix in observation]
    columns = [entry.col.astype(np.int64) * size + value[entry.row] for entry in entries]
    used, compact = np.unique(np.concatenate(columns), return_inverse=True)
    parts = np.split(compact, np.cumsum([len(column) for column in columns])[:-1])
    shape_of = (model.joint_states, len(used))
    return [
        sparse.csr_array((entry.data, (entry.row, part)), shape=shape_of)
        for entry, part in zip(entries, parts, strict=True)
    ]


def _legal(model: FactoredPOMDP, actions: list[dict[str, Value]]) -> Bool[np.ndarray, "actions states"]:
    allowed = np.ones((len(actions), count(model.states)), dtype=bool)
    shape = [variable.size for variable in model.states]
    for factor in model.legal.values():
        for number, action in enumerate(actions):
            table = factor.condition({name: action[name] for name in factor.names if name in action})
            allowed[number] &= np.broadcast_to(table.array_over(model.states), shape).ravel() > 0
    return allowed


def _check_legal(model: FactoredPOMDP, legal: np.ndarray, class_of: np.ndarray, class_start: np.ndarray) -> None:
    if not model.legal:
        return
    if (legal != legal[:, class_start[class_of]]).any():
        names = sorted(set(itertools.chain(*(factor.names for factor in model.legal.values()))) - _names(model.actions))
        raise ValueError(
            f"legal actions of {model.name} depend on {', '.join(names)}, which the agent cannot always tell; "
            "declare it as known, or let an action be legal wherever it is legal in one state that looks the same"
        )
    if not legal.any(axis=0).all():
        raise ValueError(f"{model.name} has a joint state in which no joint action is legal")


def _names(variables: Any) -> set[str]:
    return {variable.name for variable in variables}


def row_of(flat: FlatModel, state: Mapping[str, Value]) -> int:
    """Row of a joint state."""
    index = [variable.index(state[variable.name]) for variable in flat.model.states]
    return int(flat.rank[np.ravel_multi_index(index, [variable.size for variable in flat.model.states])])
