"""Compiled loops of the point-based search: belief nodes, found again by a hash, and their successors."""

from __future__ import annotations

from typing import no_type_check

import numpy as np

from solvers.compilation import compiled, part

__all__ = ["expand", "insert_all", "node_of"]

_SAME = 1e-12


@part
@no_type_check
def _hashed(entries, first, length):
    found = np.uint64(14695981039346656037)
    for j in range(first, first + length):
        entry = entries[j]
        part = entry.state * 1000003 + np.int64(entry.chance * 1e10 + 0.5)
        found = (found ^ np.uint64(part)) * np.uint64(1099511628211)
        found ^= found >> np.uint64(29)
    return found


@compiled
@no_type_check
def insert_all(nodes, entries, table):
    """Fill the hash table anew."""
    mask = np.uint64(table.shape[0] - 1)
    for number in range(nodes.shape[0]):
        place = _hashed(entries, nodes[number].start, nodes[number].length) & mask
        while table[place] >= 0:
            place = (place + np.uint64(1)) & mask
        table[place] = number


@part
@no_type_check
def node_of(tables, search, length):
    """The node of the belief that stands behind the last entries; it is added if there is none."""
    used, nodes, entries, table = search.used[0], search.nodes, search.entries, search.table
    first = used.entries
    mask = np.uint64(table.shape[0] - 1)
    place = _hashed(entries, first, length) & mask
    while table[place] >= 0:
        other = nodes[table[place]]
        same = other.length == length
        for j in range(length):
            if not same:
                break
            one, two = entries[other.start + j], entries[first + j]
            same = one.state == two.state and -_SAME <= one.chance - two.chance <= _SAME
        if same:
            return table[place]
        place = (place + np.uint64(1)) & mask
    number = used.nodes
    table[place] = number
    used.nodes += 1
    used.entries += length
    node = nodes[number]
    node.kind = tables.class_of[entries[first].state]
    node.start = first
    node.length = length
    node.best = -1
    node.vectors = 0
    node.logged = 0
    node.next_point = -2
    node.lower = -np.inf
    states, informed, expected, choices = search.states, search.informed, tables.reward, search.choices[number]
    plane, best = 0.0, -np.inf
    for j in range(first, first + length):
        plane += entries[j].chance * states[entries[j].state].corner
    for action in range(choices.shape[0]):
        worth, reward = 0.0, 0.0
        for j in range(first, first + length):
            entry = entries[j]
            worth += entry.chance * informed[action, entry.state]
            reward += entry.chance * expected[action, entry.state]
        choice = choices[action]
        choice.edge = -1
        choice.edges = 0
        choice.upper = worth
        choice.reward = reward
        if worth > best:
            best = worth
    node.plane = plane
    node.upper = best if best < plane else plane
    return number


@part
@no_type_check
def expand(tables, search, number, action, needed):
    """The beliefs that follow a node under an action; false where room is missing (``needed`` then says how much)."""
    used, entries, columns, slots = search.used[0], search.entries, search.columns, search.slots
    states = search.states
    seen_start, seen_column, seen_chance = tables.seen_start, tables.seen_column, tables.seen_chance
    actions, size = tables.reward.shape
    count = _move(tables, search, number, action)
    views, total = 0, 0
    for i in range(count):
        row = action * size + states[i].touched
        for k in range(seen_start[row], seen_start[row + 1]):
            column = columns[seen_column[k]]
            if column.slot < 0:
                column.slot = views
                slot = slots[views]
                slot.column = seen_column[k]
                slot.length = 0
                slot.mass = 0.0
                views += 1
            slots[column.slot].length += 1
            total += 1
    fits = (
        used.nodes + views < search.nodes.shape[0]
        and 2 * (used.nodes + views) < search.table.shape[0]
        and used.entries + total < entries.shape[0]
        and used.edges + views < search.edges.shape[0]
    )
    if fits:
        place = used.entries
        for i in range(views):
            slots[i].place = place
            place += slots[i].length
        for i in range(count):
            after = states[i].touched
            row = action * size + after
            for k in range(seen_start[row], seen_start[row + 1]):
                slot = slots[columns[seen_column[k]].slot]
                entry = entries[slot.place]
                entry.state = after
                entry.chance = states[after].mass * seen_chance[k]
                slot.mass += entry.chance
                slot.place += 1
        choice = search.choices[number, action]
        choice.edge = used.edges
        choice.edges = views
        for i in range(views):
            slot, edge = slots[i], search.edges[used.edges]
            shift = slot.place - slot.length - used.entries
            for j in range(used.entries, used.entries + slot.length):
                entries[j].state = entries[j + shift].state
                entries[j].chance = entries[j + shift].chance / slot.mass
            edge.column = slot.column
            edge.chance = slot.mass
            edge.child = node_of(tables, search, slot.length)
            used.edges += 1
        used.work += total * (1 + actions)
    else:
        needed[0].nodes = views + 1
        needed[0].entries = total + 1
        needed[0].edges = views + 1
    for i in range(views):
        columns[slots[i].column].slot = -1
    for i in range(count):
        states[states[i].touched].mass = 0.0
    return fits


@part
@no_type_check
def _move(tables, search, number, action):
    """Mass of the states that follow a node under an action; how many, in order, are touched."""
    node, entries, states = search.nodes[number], search.entries, search.states
    move_start, move_state, move_chance = tables.move_start, tables.move_state, tables.move_chance
    count = 0
    for j in range(node.start, node.start + node.length):
        entry = entries[j]
        row = action * tables.reward.shape[1] + entry.state
        for k in range(move_start[row], move_start[row + 1]):
            after = move_state[k]
            if states[after].mass == 0.0:
                states[count].touched = after
                count += 1
            states[after].mass += entry.chance * move_chance[k]
    # Shell's sort; numpy's takes two seconds to compile.
    gap = 1
    while gap < count:
        gap = 3 * gap + 1
    while gap > 0:
        for i in range(gap, count):
            after, place = states[i].touched, i
            while place >= gap and states[place - gap].touched > after:
                states[place].touched = states[place - gap].touched
                place -= gap
            states[place].touched = after
        gap //= 3
    return count
