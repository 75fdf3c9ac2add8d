"""Compiled loops of the point-based search: belief nodes, found again by a hash, and their successors."""

from __future__ import annotations

from typing import no_type_check

import numpy as np
from numba import njit

from solvers.search_state import EDGES, ENTRIES, NODES, WORK

__all__ = ["add_root", "expand", "insert_all"]

_SAME = 1e-12


@njit(cache=True)
@no_type_check
def _hashed(search, first, length):
    found = np.uint64(14695981039346656037)
    for j in range(first, first + length):
        part = search.entry_state[j] * 1000003 + np.int64(search.entry_chance[j] * 1e10 + 0.5)
        found = (found ^ np.uint64(part)) * np.uint64(1099511628211)
        found ^= found >> np.uint64(29)
    return found


@njit(cache=True)
@no_type_check
def _same(search, node, first, length):
    if search.node_length[node] != length:
        return False
    start = search.node_start[node]
    for j in range(length):
        if search.entry_state[start + j] != search.entry_state[first + j]:
            return False
        if abs(search.entry_chance[start + j] - search.entry_chance[first + j]) > _SAME:
            return False
    return True


@njit(cache=True)
@no_type_check
def insert_all(search):
    """Fill the hash table anew."""
    mask = np.uint64(search.table.shape[0] - 1)
    for node in range(search.used[NODES]):
        place = _hashed(search, search.node_start[node], search.node_length[node]) & mask
        while search.table[place] >= 0:
            place = (place + np.uint64(1)) & mask
        search.table[place] = node


@njit(cache=True)
@no_type_check
def _node_of(tables, search, length):
    """The node of the belief that stands behind the last entries; it is added if there is none."""
    first = search.used[ENTRIES]
    mask = np.uint64(search.table.shape[0] - 1)
    place = _hashed(search, first, length) & mask
    while search.table[place] >= 0:
        if _same(search, search.table[place], first, length):
            return search.table[place]
        place = (place + np.uint64(1)) & mask
    node = search.used[NODES]
    search.table[place] = node
    search.used[NODES] += 1
    search.used[ENTRIES] += length
    search.node_class[node] = tables.class_of[search.entry_state[first]]
    search.node_start[node] = first
    search.node_length[node] = length
    search.node_lower[node] = -np.inf
    search.node_best[node] = -1
    search.node_vectors[node] = 0
    search.node_logged[node] = 0
    search.node_next_point[node] = -2
    plane, best = 0.0, -np.inf
    for j in range(first, first + length):
        plane += search.entry_chance[j] * search.corner[search.entry_state[j]]
    for action in range(tables.reward.shape[0]):
        search.choice_edge[node, action] = -1
        search.choice_edges[node, action] = 0
        worth, reward = 0.0, 0.0
        for j in range(first, first + length):
            worth += search.entry_chance[j] * search.informed[action, search.entry_state[j]]
            reward += search.entry_chance[j] * tables.reward[action, search.entry_state[j]]
        search.choice_upper[node, action] = worth
        search.choice_reward[node, action] = reward
        best = max(best, worth)
    search.node_plane[node] = plane
    search.node_upper[node] = min(plane, best)
    return node


@njit(cache=True)
@no_type_check
def add_root(tables, search, states, chances):
    """The node of a belief; room must be there."""
    first = search.used[ENTRIES]
    for j in range(states.shape[0]):
        search.entry_state[first + j] = states[j]
        search.entry_chance[first + j] = chances[j]
    return _node_of(tables, search, states.shape[0])


@njit(cache=True)
@no_type_check
def expand(tables, search, node, action, needed):
    """The beliefs that follow a node under an action; false where room is missing (``needed`` then says how much)."""
    states = tables.reward.shape[1]
    count = 0
    for j in range(search.node_start[node], search.node_start[node] + search.node_length[node]):
        row = action * states + search.entry_state[j]
        for k in range(tables.move_start[row], tables.move_start[row + 1]):
            after = tables.move_state[k]
            if search.mass[after] == 0.0:
                search.touched[count] = after
                count += 1
            search.mass[after] += search.entry_chance[j] * tables.move_chance[k]
    touched = np.sort(search.touched[:count])
    entries, slots = 0, 0
    for after in touched:
        row = action * states + after
        for k in range(tables.seen_start[row], tables.seen_start[row + 1]):
            column = tables.seen_column[k]
            if search.slot_of[column] < 0:
                search.slot_of[column] = slots
                slots += 1
            entries += 1
    columns = np.empty(slots, np.int64)
    lengths = np.zeros(slots + 1, np.int64)
    for after in touched:
        row = action * states + after
        for k in range(tables.seen_start[row], tables.seen_start[row + 1]):
            slot = search.slot_of[tables.seen_column[k]]
            columns[slot] = tables.seen_column[k]
            lengths[slot + 1] += 1
    fits = (
        search.used[NODES] + slots < search.node_class.shape[0]
        and 2 * (search.used[NODES] + slots) < search.table.shape[0]
        and search.used[ENTRIES] + entries < search.entry_state.shape[0]
        and search.used[EDGES] + slots < search.edge_child.shape[0]
    )
    if fits:
        starts = np.cumsum(lengths)
        filled = starts[:-1].copy()
        follow_state = np.empty(entries, np.int64)
        follow_mass = np.empty(entries)
        for after in touched:
            row = action * states + after
            for k in range(tables.seen_start[row], tables.seen_start[row + 1]):
                slot = search.slot_of[tables.seen_column[k]]
                follow_state[filled[slot]] = after
                follow_mass[filled[slot]] = search.mass[after] * tables.seen_chance[k]
                filled[slot] += 1
        edge = search.used[EDGES]
        search.choice_edge[node, action] = edge
        search.choice_edges[node, action] = slots
        search.used[EDGES] += slots
        for slot in range(slots):
            total = follow_mass[starts[slot] : starts[slot + 1]].sum()
            first = search.used[ENTRIES]
            for j in range(starts[slot], starts[slot + 1]):
                search.entry_state[first + j - starts[slot]] = follow_state[j]
                search.entry_chance[first + j - starts[slot]] = follow_mass[j] / total
            search.edge_chance[edge + slot] = total
            search.edge_column[edge + slot] = columns[slot]
            search.edge_child[edge + slot] = _node_of(tables, search, starts[slot + 1] - starts[slot])
        search.used[WORK] += entries * (1 + tables.reward.shape[0])
    else:
        needed[NODES], needed[ENTRIES], needed[EDGES] = slots + 1, entries + 1, slots + 1
    for column in columns:
        search.slot_of[column] = -1
    for after in touched:
        search.mass[after] = 0.0
    return fits
