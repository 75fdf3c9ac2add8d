"""Compiled sweeps over flat tables: Bellman backups, their fast informed form, and the values of fixed choices."""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from numba import njit

__all__ = ["action_values", "fixed_sweeps", "informed_sweep", "optimal_sweeps"]


@njit(cache=True)
@no_type_check
def action_values(tables, value):
    """``Q(a, s) = R(a, s) + γ Σ P(s' | s, a) V(s')``; minus infinity where an action is not legal."""
    actions, states = tables.reward.shape
    found = np.empty((actions, states))
    for action in range(actions):
        for state in range(states):
            if not tables.legal[action, state]:
                found[action, state] = -np.inf
                continue
            row = action * states + state
            total = 0.0
            for j in range(tables.move_start[row], tables.move_start[row + 1]):
                total += tables.move_chance[j] * value[tables.move_state[j]]
            found[action, state] = tables.reward[action, state] + tables.discount * total
    return found


@njit(cache=True)
@no_type_check
def optimal_sweeps(tables, value, sweeps, tolerance):
    """Value iteration in place; the last sweep's smallest and largest change, and the sweeps that were made.

    Stops where the bounds that the changes give (MacQueen; Porteus) are closer than ``tolerance``.
    """
    actions, states = tables.reward.shape
    before = value.copy()
    low, high, done = 0.0, 0.0, 0
    for _ in range(sweeps):
        low, high = np.inf, -np.inf
        for state in range(states):
            best = -np.inf
            for action in range(actions):
                if tables.legal[action, state]:
                    row = action * states + state
                    total = 0.0
                    for j in range(tables.move_start[row], tables.move_start[row + 1]):
                        total += tables.move_chance[j] * before[tables.move_state[j]]
                    best = max(best, tables.reward[action, state] + tables.discount * total)
            value[state] = best
            low, high = min(low, best - before[state]), max(high, best - before[state])
        before[:] = value
        done += 1
        if tables.discount < 1 and tables.discount * (high - low) <= tolerance * (1 - tables.discount):
            break
    return low, high, done


@njit(cache=True)
@no_type_check
def fixed_sweeps(tables, choice, value, sweeps, tolerance):
    """The value of always choosing ``choice[s]`` in state s, in place; as `optimal_sweeps`."""
    states = value.shape[0]
    before = value.copy()
    low, high = 0.0, 0.0
    for _ in range(sweeps):
        low, high = np.inf, -np.inf
        for state in range(states):
            row = choice[state] * states + state
            total = 0.0
            for j in range(tables.move_start[row], tables.move_start[row + 1]):
                total += tables.move_chance[j] * before[tables.move_state[j]]
            value[state] = tables.reward[choice[state], state] + tables.discount * total
            change = value[state] - before[state]
            low, high = min(low, change), max(high, change)
        before[:] = value
        if tables.discount < 1 and tables.discount * (high - low) <= tolerance * (1 - tables.discount):
            break
    return low, high


@njit(cache=True)
@no_type_check
def informed_sweep(tables, vectors):
    """One fast informed backup ``α_a(s) = R(a, s) + γ Σ_z max_a' Σ_s' P(z, s' | s, a) α_a'(s')``.

    Parameters
    ----------
    vectors : (A, N) float
        Minus infinity where an action is not legal.
    """
    actions, states = tables.reward.shape
    found = np.empty((actions, states))
    sums = np.zeros((tables.columns, actions))
    touched = np.empty(tables.columns, np.int64)
    is_touched = np.zeros(tables.columns, np.bool_)
    for action in range(actions):
        for state in range(states):
            if not tables.legal[action, state]:
                found[action, state] = -np.inf
                continue
            count = 0
            row = action * states + state
            for j in range(tables.move_start[row], tables.move_start[row + 1]):
                after, chance = tables.move_state[j], tables.move_chance[j]
                seen = action * states + after
                for k in range(tables.seen_start[seen], tables.seen_start[seen + 1]):
                    column = tables.seen_column[k]
                    if not is_touched[column]:
                        is_touched[column] = True
                        touched[count] = column
                        count += 1
                    weight = chance * tables.seen_chance[k]
                    for other in range(actions):
                        sums[column, other] += weight * vectors[other, after]
            total = 0.0
            for i in range(count):
                column = touched[i]
                total += sums[column].max()
                sums[column] = 0.0
                is_touched[column] = False
            found[action, state] = tables.reward[action, state] + tables.discount * total
    return found
