"""The smallest set of alpha vectors with the same maximum everywhere: pointwise dominance, then witness programs.

A vector w stays if some belief b has ``w · b > u · b`` for all vectors u kept so far: maximise ``w · b − t`` subject to
``t ≥ u · b`` and ``Σ b = 1`` (Lark's filter; White 1991). HiGHS solves it directly: between two vectors only the
objective changes, and a vector that is kept adds a row, so that every solve starts from the last basis.
A vector is dropped only where the program's own dual proves it: ``Σ λ_u u ≥ w − tolerance`` in every state. So no
tolerance of the linear program can lose a vector that matters; at worst one too many stays.
With one state the best stays; with two the upper envelope of lines is taken by a sweep, without programs.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from jaxtyping import Float, Int

from solvers.alpha_vectors import undominated

__all__ = ["parsimonious"]

_TOLERANCE = 1e-12
_POINTS_A_STATE = 8


def parsimonious(
    vectors: Float[np.ndarray, "k states"], points: Float[np.ndarray, "p states"] | None = None
) -> tuple[Int[np.ndarray, " kept"], Float[np.ndarray, "witnesses states"]]:
    """Positions of the vectors that are the best somewhere, and beliefs where they are.

    Parameters
    ----------
    points : (P, N) float, optional
        Beliefs to look at first: each saves a linear program where a vector turns out to be the best there.
    """
    number, states = vectors.shape
    if states == 1 or number <= 1:
        return np.array([int(vectors[:, 0].argmax())]), np.full((1, states), 1 / states)
    tolerance = _TOLERANCE * max(1.0, float(np.abs(vectors).max()))
    if states == 2:
        return _envelope(vectors), np.empty((0, 2))
    left = np.flatnonzero(undominated(vectors, tolerance))
    kept, witnesses = _witnessed(vectors[left], tolerance, np.empty((0, states)) if points is None else points)
    return left[kept], witnesses


def _envelope(lines: Float[np.ndarray, "k two"]) -> Int[np.ndarray, " kept"]:
    """The upper envelope of ``(1 − p) v₀ + p v₁`` over p in [0, 1], by a sweep from p = 0."""
    kept: list[int] = []
    crossings: list[float] = []
    for position in np.lexsort((-lines[:, 1], -lines[:, 0])).tolist():
        then = lines[position]
        if kept and then[1] <= lines[kept[-1], 1]:
            continue
        while kept:
            first = lines[kept[-1]]
            crossing = float((first[0] - then[0]) / ((first[0] - then[0]) + (then[1] - first[1])))
            if len(kept) > 1 and crossing <= crossings[-1]:
                kept.pop()
                crossings.pop()
                continue
            if crossing <= 0.0:
                kept.pop()
                continue
            crossings.append(crossing)
            break
        kept.append(position)
    return np.array(kept)


def _witnessed(
    vectors: Float[np.ndarray, "k states"], tolerance: float, points: Float[np.ndarray, "p states"]
) -> tuple[Int[np.ndarray, " kept"], Float[np.ndarray, "witnesses states"]]:
    states = vectors.shape[1]
    drawn = np.random.default_rng(0).dirichlet(np.ones(states), _POINTS_A_STATE * states)
    looked_at = np.vstack([np.eye(states), drawn, points])
    kept, first = np.unique(_best(vectors, looked_at), return_index=True)
    order, witnesses = kept.tolist(), list(looked_at[first])
    program = _Program(states)
    for position in order:
        program.add(vectors[position])
    is_kept = np.zeros(len(vectors), dtype=bool)
    is_kept[order] = True
    waiting = np.flatnonzero(~is_kept).tolist()
    while waiting:
        position = waiting.pop()
        belief, weights = program.solve(vectors[position])
        if (vectors[position] - weights @ vectors[order]).max() <= tolerance:
            continue
        others = np.array([*waiting, position])
        better = int(others[(vectors[others] @ belief).argmax()])
        if (vectors[order] @ belief).max() >= vectors[better] @ belief:
            better = position
        if better != position:
            waiting[waiting.index(better)] = position
        program.add(vectors[better])
        order.append(better)
        witnesses.append(belief)
    return np.sort(order), np.array(witnesses)


def _best(vectors: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Position of the best vector at each point, a few points at a time."""
    rows = max(1, 20_000_000 // len(vectors))
    parts = [(points[first : first + rows] @ vectors.T).argmax(axis=1) for first in range(0, len(points), rows)]
    return np.concatenate(parts)


class _Program:
    """``min t`` with ``Σ_u λ_u u(s) + t ≥ w(s)`` in every state, ``Σ λ = 1``: the witness program's dual, kept warm.

    It has as few rows as there are states, however many vectors there are; its own duals are the belief.
    """

    def __init__(self, states: int) -> None:
        import highspy

        self.states = states
        self.model: Any = highspy.Highs()
        self.model.setOptionValue("output_flag", False)
        for name in ("primal_feasibility_tolerance", "dual_feasibility_tolerance"):
            self.model.setOptionValue(name, 1e-10)
        self.model.setOptionValue("presolve", "off")
        self.infinity = highspy.kHighsInf
        for _ in range(states):
            self.model.addRow(0.0, self.infinity, 0, [], [])
        self.model.addRow(1.0, 1.0, 0, [], [])
        self.rows = np.arange(states + 1, dtype=np.int32)
        self.model.addCol(1.0, -self.infinity, self.infinity, states, self.rows[:-1], np.ones(states))

    def add(self, vector: Float[np.ndarray, " states"]) -> None:
        """One more vector to be better than."""
        self.model.addCol(0.0, 0.0, self.infinity, self.states + 1, self.rows, np.append(vector, 1.0))

    def solve(self, vector: Float[np.ndarray, " states"]) -> tuple[np.ndarray, np.ndarray]:
        """The belief where a vector is best by most, and weights of the others that come closest to it from above."""
        for row, number in enumerate(vector.tolist()):
            self.model.changeRowBounds(row, number, self.infinity)
        self.model.run()
        found = self.model.getSolution()
        belief = np.abs(np.array(found.row_dual)[:-1])
        weights = np.maximum(np.array(found.col_value)[1:], 0.0)
        return belief / max(belief.sum(), 1e-300), weights / max(weights.sum(), 1e-300)
