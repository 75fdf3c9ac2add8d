"""Compiled loops of the point-based search: both bounds at belief nodes, trials from the root.

A node's upper bound sees every entry of its class's log of improved points once, and its lower bound every vector once:
what was not improved since is not looked at again.
"""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from numba import njit

from solvers.belief_nodes import expand
from solvers.search_state import LOGGED, NUMBERS, POINTS, VECTORS, WORK

__all__ = ["add_vector", "run_trials"]

_DEEPEST = 1000


@njit(cache=True)
@no_type_check
def _sawtooth(search, point, plane, best):
    """``min(best, the bound that one point gives)`` for the belief in the buffer."""
    drop = search.node_upper[point] - search.node_plane[point]
    if drop >= 0.0:
        return best
    enough = (best - plane) / drop
    ratio = np.inf
    first = search.node_start[point]
    for j in range(first, first + search.node_length[point]):
        chance = search.buffer[search.entry_state[j]]
        if chance <= enough * search.entry_chance[j]:
            return best
        ratio = min(ratio, chance / search.entry_chance[j])
    return min(best, plane + ratio * drop)


@njit(cache=True)
@no_type_check
def _refresh_upper(search, node):
    kind = search.node_class[node]
    seen = search.node_logged[node]
    if search.class_log[kind] < seen:
        return
    first, past = search.node_start[node], search.node_start[node] + search.node_length[node]
    for j in range(first, past):
        search.buffer[search.entry_state[j]] = search.entry_chance[j]
    best, plane, looked = search.node_upper[node], search.node_plane[node], 0
    if seen == 0:
        point = search.class_point[kind]
        while point >= 0:
            best = _sawtooth(search, point, plane, best)
            point = search.node_next_point[point]
            looked += 1
    else:
        entry = search.class_log[kind]
        while entry >= seen:
            best = _sawtooth(search, search.log_node[entry], plane, best)
            entry = search.log_next[entry]
            looked += 1
    for j in range(first, past):
        search.buffer[search.entry_state[j]] = 0.0
    search.node_upper[node] = best
    search.node_logged[node] = search.used[LOGGED]
    search.used[WORK] += 3 * looked + past - first


@njit(cache=True)
@no_type_check
def _refresh_lower(tables, search, node):
    kind = search.node_class[node]
    vector = search.class_vector[kind]
    seen = search.node_vectors[node]
    if vector < seen:
        return
    first, past = search.node_start[node], search.node_start[node] + search.node_length[node]
    base = tables.class_start[kind]
    best, lower, looked = search.node_best[node], search.node_lower[node], 0
    while vector >= seen:
        start = search.vector_start[vector] - base
        worth = 0.0
        for j in range(first, past):
            worth += search.entry_chance[j] * search.vector_number[start + search.entry_state[j]]
        if worth > lower:
            lower, best = worth, vector
        vector = search.vector_next[vector]
        looked += 1
    search.node_best[node], search.node_lower[node] = best, lower
    search.node_vectors[node] = search.used[VECTORS]
    search.used[WORK] += (looked + 1) * (past - first)


@njit(cache=True)
@no_type_check
def _log(search, node):
    kind, entry = search.node_class[node], search.used[LOGGED]
    if search.node_next_point[node] == -2:
        search.node_next_point[node] = search.class_point[kind]
        search.class_point[kind] = node
        search.used[POINTS] += 1
    search.log_node[entry] = node
    search.log_next[entry] = search.class_log[kind]
    search.class_log[kind] = entry
    search.used[LOGGED] += 1


@njit(cache=True)
@no_type_check
def _update_upper(tables, search, node, slack, needed):
    """Back the upper bound up, looking only at actions that may be the best; false where room is missing."""
    if search.used[LOGGED] + 1 >= search.log_node.shape[0]:
        needed[LOGGED] = 2
        return False
    actions = tables.reward.shape[0]
    fresh = np.zeros(actions, np.bool_)
    while True:
        action = np.argmax(search.choice_upper[node])
        if fresh[action]:
            break
        fresh[action] = True
        if search.choice_edge[node, action] < 0 and not expand(tables, search, node, action, needed):
            return False
        first = search.choice_edge[node, action]
        total = 0.0
        for edge in range(first, first + search.choice_edges[node, action]):
            child = search.edge_child[edge]
            _refresh_upper(search, child)
            total += search.edge_chance[edge] * search.node_upper[child]
        worth = search.choice_reward[node, action] + tables.discount * total
        if worth < search.choice_upper[node, action]:
            search.choice_upper[node, action] = worth
    worth = search.choice_upper[node, action]
    before = search.node_upper[node]
    if worth < before:
        _refresh_upper(search, node)
        before = search.node_upper[node]
        if worth < before:
            search.node_upper[node] = worth
            if before - worth > slack or search.node_next_point[node] != -2:
                _log(search, node)
    return True


@njit(cache=True)
@no_type_check
def add_vector(tables, search, kind, action, numbers):
    """Add a vector unless another is nowhere below it; take out those that it is nowhere below."""
    size, start = numbers.shape[0], search.used[NUMBERS]
    vector, before = search.class_vector[kind], -1
    while vector >= 0:
        place = search.vector_start[vector]
        above, below = True, True
        for j in range(size):
            other = search.vector_number[place + j]
            if numbers[j] > other:
                above = False
                if not below:
                    break
            elif numbers[j] < other:
                below = False
                if not above:
                    break
        following = search.vector_next[vector]
        if above:
            return False
        if below:
            if before < 0:
                search.class_vector[kind] = following
            else:
                search.vector_next[before] = following
        else:
            before = vector
        vector = following
    new = search.used[VECTORS]
    search.vector_number[start : start + size] = numbers
    search.vector_class[new], search.vector_action[new], search.vector_start[new] = kind, action, start
    search.vector_next[new] = search.class_vector[kind]
    search.class_vector[kind] = new
    search.used[VECTORS] += 1
    search.used[NUMBERS] += size
    worth = numbers.sum()
    if worth > search.class_default_worth[kind]:
        search.class_default_worth[kind] = worth
        search.class_default[kind] = new
    return True


@njit(cache=True)
@no_type_check
def _backup(tables, search, node, slack, needed):
    """Back the lower bound up over the actions that were looked at; false where room is missing."""
    states, kind = tables.reward.shape[1], search.node_class[node]
    base, size = tables.class_start[kind], tables.class_start[kind + 1] - tables.class_start[kind]
    if (
        search.used[VECTORS] + 1 >= search.vector_class.shape[0]
        or search.used[NUMBERS] + size >= search.vector_number.shape[0]
    ):
        needed[VECTORS], needed[NUMBERS] = 2, size + 1
        return False
    _refresh_lower(tables, search, node)
    best, action = -np.inf, -1
    for other in range(tables.reward.shape[0]):
        first = search.choice_edge[node, other]
        if first < 0 or search.choice_upper[node, other] <= search.node_lower[node] + slack:
            continue
        total = 0.0
        for edge in range(first, first + search.choice_edges[node, other]):
            child = search.edge_child[edge]
            _refresh_lower(tables, search, child)
            total += search.edge_chance[edge] * search.node_lower[child]
        worth = search.choice_reward[node, other] + tables.discount * total
        if worth > best:
            best, action = worth, other
    if best <= search.node_lower[node] + slack:
        return True
    search.stamp[0] += 1
    stamp, first = search.stamp[0], search.choice_edge[node, action]
    for edge in range(first, first + search.choice_edges[node, action]):
        search.column_vector[search.edge_column[edge]] = search.node_best[search.edge_child[edge]]
        search.column_stamp[search.edge_column[edge]] = stamp
    numbers = np.empty(size)
    for state in range(base, base + size):
        row = action * states + state
        total = 0.0
        for k in range(tables.move_start[row], tables.move_start[row + 1]):
            after = tables.move_state[k]
            if search.ahead_stamp[after] != stamp:
                search.ahead_stamp[after] = stamp
                search.ahead[after] = _seen_ahead(tables, search, action * states + after, after, stamp)
            total += tables.move_chance[k] * search.ahead[after]
        numbers[state - base] = tables.reward[action, state] + tables.discount * total
    search.used[WORK] += size * 10
    add_vector(tables, search, kind, action, numbers)
    _refresh_lower(tables, search, node)
    return True


@njit(cache=True)
@no_type_check
def _seen_ahead(tables, search, row, after, stamp):
    """``Σ_z P(z | s', a) α_z(s')`` with the vectors that were chosen for the observations."""
    kind = tables.class_of[after]
    place = after - tables.class_start[kind]
    total = 0.0
    for k in range(tables.seen_start[row], tables.seen_start[row + 1]):
        column = tables.seen_column[k]
        vector = search.column_vector[column] if search.column_stamp[column] == stamp else search.class_default[kind]
        total += tables.seen_chance[k] * search.vector_number[search.vector_start[vector] + place]
    return total


@njit(cache=True)
@no_type_check
def run_trials(tables, search, root, precision, share, work, needed):
    """Trials from the root: 0 where the gap is closed, 1 where the work is done, 2 where room is missing.

    Each goes down by the best upper bound and the widest weighted gap, while the gap exceeds ``target / γ^depth``, and
    backs both bounds up on its way back. The target is ``share`` of the root's gap, and never below the precision.
    """
    path = np.empty(_DEEPEST, np.int64)
    end = search.used[WORK] + work
    slack = 1e-4 * precision
    while True:
        if not _update_upper(tables, search, root, slack, needed) or not _backup(tables, search, root, slack, needed):
            return 2
        gap = search.node_upper[root] - search.node_lower[root]
        if gap <= precision:
            return 0
        if search.used[WORK] >= end:
            return 1
        target = max(0.9 * precision, share * gap)
        node, depth = root, 0
        while depth < _DEEPEST:
            if not _update_upper(tables, search, node, slack, needed):
                return 2
            _refresh_lower(tables, search, node)
            if search.node_upper[node] - search.node_lower[node] <= target:
                break
            path[depth] = node
            depth += 1
            target /= tables.discount
            action = np.argmax(search.choice_upper[node])
            first = search.choice_edge[node, action]
            widest, chosen = 0.0, -1
            for edge in range(first, first + search.choice_edges[node, action]):
                child = search.edge_child[edge]
                _refresh_lower(tables, search, child)
                excess = search.node_upper[child] - search.node_lower[child] - target
                if search.edge_chance[edge] * excess > widest:
                    widest, chosen = search.edge_chance[edge] * excess, child
            if chosen < 0:
                break
            node = chosen
        for step in range(depth - 1, -1, -1):
            if not _update_upper(tables, search, path[step], slack, needed):
                return 2
            if not _backup(tables, search, path[step], slack, needed):
                return 2
