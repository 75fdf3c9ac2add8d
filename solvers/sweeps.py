"""Sweeps over flat tables: Bellman backups, their fast informed form, and the values of fixed choices."""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from jaxtyping import Bool, Float

from solvers.compilation import compiled
from solvers.flat import FlatModel, Tables

__all__ = ["action_values", "informed_sweep", "optimal_sweeps"]


def action_values(flat: FlatModel, value: Float[np.ndarray, " states"]) -> Float[np.ndarray, "actions states"]:
    """``Q(a, s) = R(a, s) + γ Σ P(s' | s, a) V(s')``; minus infinity where an action is not legal."""
    ahead = np.stack([moves @ value for moves in flat.transition])
    return np.where(flat.tables.legal, flat.reward + flat.discount * ahead, -np.inf)


def optimal_sweeps(
    tables: Tables,
    legal: Bool[np.ndarray, "actions states"],
    value: Float[np.ndarray, " states"],
    sweeps: int,
    tolerance: float,
) -> tuple[float, float]:
    """Value iteration in place over what is legal; the last sweep's smallest and largest change.

    Stops where the bounds that the changes give (MacQueen; Porteus) are closer than ``tolerance``. Where one action is
    legal in each state this is the value of always choosing it.
    """
    return _optimal_sweeps(tables, legal, value, value.copy(), sweeps, tolerance)


@compiled
@no_type_check
def _optimal_sweeps(tables, legal, value, before, sweeps, tolerance):
    move_start, move_state, move_chance = tables.move_start, tables.move_state, tables.move_chance
    reward, discount = tables.reward, tables.discount
    actions, states = reward.shape
    low, high = 0.0, 0.0
    for _ in range(sweeps):
        low, high = np.inf, -np.inf
        for state in range(states):
            best = -np.inf
            for action in range(actions):
                if legal[action, state]:
                    row = action * states + state
                    total = 0.0
                    for j in range(move_start[row], move_start[row + 1]):
                        total += move_chance[j] * before[move_state[j]]
                    worth = reward[action, state] + discount * total
                    if worth > best:
                        best = worth
            value[state] = best
            change = best - before[state]
            if change < low:
                low = change
            if change > high:
                high = change
        for state in range(states):
            before[state] = value[state]
        if discount < 1 and discount * (high - low) <= tolerance * (1 - discount):
            break
    return low, high


def informed_sweep(tables: Tables, vectors: Float[np.ndarray, "actions states"]) -> Float[np.ndarray, "actions states"]:
    """One fast informed backup ``α_a(s) = R(a, s) + γ Σ_z max_a' Σ_s' P(z, s' | s, a) α_a'(s')``.

    Parameters
    ----------
    vectors : (A, N) float
        Minus infinity where an action is not legal.
    """
    found = np.full(vectors.shape, -np.inf)
    sums, touched = np.zeros((tables.columns, len(vectors))), np.zeros((tables.columns, 2), np.int64)
    _informed_sweep(tables, vectors, found, sums, touched)
    return found


@compiled
@no_type_check
def _informed_sweep(tables, vectors, found, sums, touched):
    """``touched`` lists the observations that may follow in its first column; its second one says which they are."""
    move_start, move_state, move_chance = tables.move_start, tables.move_state, tables.move_chance
    seen_start, seen_column, seen_chance = tables.seen_start, tables.seen_column, tables.seen_chance
    reward, legal = tables.reward, tables.legal
    actions, states = reward.shape
    for action in range(actions):
        for state in range(states):
            if not legal[action, state]:
                continue
            count = 0
            row = action * states + state
            for j in range(move_start[row], move_start[row + 1]):
                after, chance = move_state[j], move_chance[j]
                seen = action * states + after
                for k in range(seen_start[seen], seen_start[seen + 1]):
                    column = seen_column[k]
                    if touched[column, 1] == 0:
                        touched[column, 1] = 1
                        touched[count, 0] = column
                        count += 1
                    weight = chance * seen_chance[k]
                    for other in range(actions):
                        sums[column, other] += weight * vectors[other, after]
            total = 0.0
            for i in range(count):
                column = touched[i, 0]
                best = sums[column, 0]
                for other in range(actions):
                    if sums[column, other] > best:
                        best = sums[column, other]
                    sums[column, other] = 0.0
                total += best
                touched[column, 1] = 0
            found[action, state] = reward[action, state] + tables.discount * total
