"""Compiled loops of the point-based search: both bounds at belief nodes, trials from the root.

A node's upper bound sees every entry of its class's log of improved points once, and its lower bound every vector once:
what was not improved since is not looked at again.
"""

from __future__ import annotations

from typing import no_type_check

import numpy as np

from solvers.belief_nodes import expand, node_of
from solvers.compilation import compiled, part

__all__ = ["add_vector", "run_trials"]


@part
@no_type_check
def _refresh_upper(search, number):
    """``min`` of the bound and of what the sawtooth gives with points that the node has not seen."""
    used, nodes, entries, buffer, log = search.used[0], search.nodes, search.entries, search.buffer, search.log
    node = nodes[number]
    kind, seen = search.kinds[node.kind], node.logged
    if kind.log < seen:
        return
    for j in range(node.start, node.start + node.length):
        buffer[entries[j].state] = entries[j].chance
    best, looked = node.upper, 0
    at = kind.log if seen else kind.point
    while at >= seen:
        point = nodes[log[at].node if seen else at]
        drop = point.upper - point.plane
        if drop < 0.0:
            enough, ratio = (best - node.plane) / drop, np.inf
            for j in range(point.start, point.start + point.length):
                entry = entries[j]
                chance = buffer[entry.state]
                if chance <= enough * entry.chance:
                    ratio = 0.0
                    break
                share = chance / entry.chance
                if share < ratio:
                    ratio = share
            if ratio > 0.0 and node.plane + ratio * drop < best:
                best = node.plane + ratio * drop
        at = log[at].next if seen else point.next_point
        looked += 1
    for j in range(node.start, node.start + node.length):
        buffer[entries[j].state] = 0.0
    node.upper = best
    node.logged = used.logged
    used.work += 3 * looked + node.length


@part
@no_type_check
def _refresh_lower(tables, search, number):
    """``max`` of the bound and of the vectors that the node has not seen."""
    used, node, entries = search.used[0], search.nodes[number], search.entries
    vectors, numbers = search.vectors, search.numbers
    vector, seen = search.kinds[node.kind].vector, node.vectors
    if vector < seen:
        return
    first, past = node.start, node.start + node.length
    base = tables.class_start[node.kind]
    best, lower, looked = node.best, node.lower, 0
    while vector >= seen:
        start = vectors[vector].start - base
        worth = 0.0
        for j in range(first, past):
            worth += entries[j].chance * numbers[start + entries[j].state]
        if worth > lower:
            lower, best = worth, vector
        vector = vectors[vector].next
        looked += 1
    node.best = best
    node.lower = lower
    node.vectors = used.vectors
    used.work += (looked + 1) * node.length


@part
@no_type_check
def _best_choice(choices, number):
    best = 0
    for action in range(1, choices.shape[1]):
        if choices[number, action].upper > choices[number, best].upper:
            best = action
    return best


@part
@no_type_check
def _update_upper(tables, search, number, slack, needed):
    """Back the upper bound up, looking only at actions that may be the best; false where room is missing."""
    used, nodes, edges, choices, log = search.used[0], search.nodes, search.edges, search.choices, search.log
    if used.logged + 1 >= log.shape[0]:
        needed[0].logged = 2
        return False
    used.stamp += 1
    stamp, looked = used.stamp, search.looked
    action = _best_choice(choices, number)
    while looked[action] != stamp:
        looked[action] = stamp
        choice = choices[number, action]
        if choice.edge < 0 and not expand(tables, search, number, action, needed):
            return False
        total = 0.0
        for j in range(choice.edge, choice.edge + choice.edges):
            _refresh_upper(search, edges[j].child)
            total += edges[j].chance * nodes[edges[j].child].upper
        worth = choice.reward + tables.discount * total
        if worth < choice.upper:
            choice.upper = worth
        action = _best_choice(choices, number)
    worth, node = choices[number, action].upper, nodes[number]
    if worth < node.upper:
        _refresh_upper(search, number)
        before = node.upper
        if worth < before:
            node.upper = worth
            if before - worth > slack or node.next_point != -2:
                kind = search.kinds[node.kind]
                if node.next_point == -2:
                    node.next_point = kind.point
                    kind.point = number
                    used.points += 1
                log[used.logged].node = number
                log[used.logged].next = kind.log
                kind.log = used.logged
                used.logged += 1
    return True


@part
@no_type_check
def add_vector(search, kind, action, size):
    """Add the vector behind the last numbers unless another is nowhere below it; take out those nowhere above it."""
    used, vectors, numbers = search.used[0], search.vectors, search.numbers
    start, worth = used.numbers, 0.0
    vector, before = kind.vector, -1
    while vector >= 0:
        place = vectors[vector].start
        above, below = True, True
        for j in range(size):
            own, other = numbers[start + j], numbers[place + j]
            if own > other:
                above = False
                if not below:
                    break
            elif own < other:
                below = False
                if not above:
                    break
        following = vectors[vector].next
        if above:
            return
        if not below:
            before = vector
        elif before < 0:
            kind.vector = following
        else:
            vectors[before].next = following
        vector = following
    new = vectors[used.vectors]
    new.action = action
    new.start = start
    new.next = kind.vector
    kind.vector = used.vectors
    for j in range(start, start + size):
        worth += numbers[j]
    if worth > kind.default_worth:
        kind.default_worth = worth
        kind.default = used.vectors
    used.vectors += 1
    used.numbers += size


@part
@no_type_check
def _backup(tables, search, number, slack, needed):
    """Back the lower bound up over the actions that were looked at; false where room is missing."""
    used, nodes, edges, vectors, numbers = search.used[0], search.nodes, search.edges, search.vectors, search.numbers
    node, choices = nodes[number], search.choices
    base = tables.class_start[node.kind]
    size = tables.class_start[node.kind + 1] - base
    if used.vectors + 1 >= vectors.shape[0] or used.numbers + size >= numbers.shape[0]:
        needed[0].vectors = 2
        needed[0].numbers = size + 1
        return False
    _refresh_lower(tables, search, number)
    best, action = -np.inf, np.int64(-1)
    for other in range(choices.shape[1]):
        choice = choices[number, other]
        if choice.edge < 0 or choice.upper <= node.lower + slack:
            continue
        total = 0.0
        for j in range(choice.edge, choice.edge + choice.edges):
            _refresh_lower(tables, search, edges[j].child)
            total += edges[j].chance * nodes[edges[j].child].lower
        worth = choice.reward + tables.discount * total
        if worth > best:
            best, action = worth, other
    if best <= node.lower + slack:
        return True
    _back_up_along(tables, search, number, action)
    add_vector(search, search.kinds[node.kind], action, size)
    _refresh_lower(tables, search, number)
    return True


@part
@no_type_check
def _back_up_along(tables, search, number, action):
    """``R(s, a) + γ Σ_s' P(s' | s, a) Σ_z P(z | s', a) α_z(s')``, written behind the last numbers.

    The vector of an observation is the best one of the belief that follows it.
    """
    used, nodes, edges, vectors, numbers = search.used[0], search.nodes, search.edges, search.vectors, search.numbers
    columns, kinds, states = search.columns, search.kinds, search.states
    move_start, move_state, move_chance = tables.move_start, tables.move_state, tables.move_chance
    seen_start, seen_column, seen_chance = tables.seen_start, tables.seen_column, tables.seen_chance
    class_of, class_start, reward = tables.class_of, tables.class_start, tables.reward
    used.stamp += 1
    choice = search.choices[number, action]
    for j in range(choice.edge, choice.edge + choice.edges):
        column = columns[edges[j].column]
        column.vector = nodes[edges[j].child].best
        column.stamp = used.stamp
    base, past = class_start[nodes[number].kind], class_start[nodes[number].kind + 1]
    for state in range(base, past):
        row = action * reward.shape[1] + state
        total = 0.0
        for k in range(move_start[row], move_start[row + 1]):
            after = move_state[k]
            if states[after].stamp != used.stamp:
                states[after].stamp = used.stamp
                kind, seen, worth = class_of[after], action * reward.shape[1] + after, 0.0
                for i in range(seen_start[seen], seen_start[seen + 1]):
                    column = columns[seen_column[i]]
                    vector = column.vector if column.stamp == used.stamp else kinds[kind].default
                    worth += seen_chance[i] * numbers[vectors[vector].start + after - class_start[kind]]
                states[after].ahead = worth
            total += move_chance[k] * states[after].ahead
        numbers[used.numbers + state - base] = reward[action, state] + tables.discount * total
    used.work += (past - base) * 10


@compiled
@no_type_check
def run_trials(tables, search, support, precision, share, work, needed):
    """Trials from the root: 0 where the gap is closed, 1 where the work is done, 2 where room is missing.

    Each goes down by the best upper bound and the widest weighted gap, while the gap exceeds ``target / γ^depth``, and
    backs both bounds up on its way back. The target is ``share`` of the root's gap, and never below the precision. The
    root is node 0; it is made of the first ``support`` entries. A trial goes down, then up again along its path.
    """
    used, nodes, edges, choices, path = search.used[0], search.nodes, search.edges, search.choices, search.path
    if used.nodes == 0:
        node_of(tables, search, support)
    end, slack, target = used.work + work, 1e-4 * precision, 0.0
    number, depth, descends = path[0], 0, False
    while True:
        if not _update_upper(tables, search, number, slack, needed):
            return 2
        if descends:
            _refresh_lower(tables, search, number)
            following = np.int64(-1)
            if nodes[number].upper - nodes[number].lower > target:
                path[depth] = number
                depth += 1
                target /= tables.discount
                choice, widest = choices[number, _best_choice(choices, number)], 0.0
                for j in range(choice.edge, choice.edge + choice.edges):
                    edge = edges[j]
                    _refresh_lower(tables, search, edge.child)
                    excess = nodes[edge.child].upper - nodes[edge.child].lower - target
                    if edge.chance * excess > widest:
                        widest, following = edge.chance * excess, edge.child
            descends = following >= 0 and depth < path.shape[0]
            number = following if descends else path[depth - 1 if depth else 0]
            continue
        if not _backup(tables, search, number, slack, needed):
            return 2
        if depth > 0:
            # Back along the path, and once more at the root.
            depth -= 1
            number = path[depth - 1 if depth else 0]
            continue
        gap = nodes[0].upper - nodes[0].lower
        if gap <= precision:
            return 0
        if used.work >= end:
            return 1
        target, descends = share * gap, True
        if target < 0.9 * precision:
            target = 0.9 * precision
