"""Arrays of the point-based search: belief nodes, what follows them, alpha vectors, the log of upper bounds.

Everything lives in flat arrays that compiled loops read and write and that grow by copying.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from solvers.flat import FlatModel

__all__ = ["Search", "grown", "new_search"]

NODES, ENTRIES, EDGES, VECTORS, NUMBERS, LOGGED, POINTS, WORK, MERGED = range(9)
"""Places in `Search.used`."""

_NODE_SIZED = (
    "node_class", "node_start", "node_length", "node_upper", "node_lower", "node_best", "node_vectors", "node_logged",
    "node_plane", "node_next_point",
)  # fmt: skip
_PER_ACTION = ("choice_upper", "choice_reward", "choice_edge", "choice_edges")
_SIZES = {
    ENTRIES: ("entry_state", "entry_chance"),
    EDGES: ("edge_chance", "edge_child", "edge_column"),
    VECTORS: ("vector_class", "vector_action", "vector_start", "vector_next"),
    NUMBERS: ("vector_number",),
    LOGGED: ("log_node", "log_next"),
}


class Search(NamedTuple):
    """The state of a search.

    Attributes
    ----------
    used : (9,) int
        Used lengths.
    node_* : (nodes,)
        Class, place of the belief among the entries, bounds, best vector, how many vectors and log entries the bounds
        have seen, plane of the corners, next point of the class (-2: no point).
    choice_* : (nodes, A)
        Upper bound of an action, its expected reward, its first edge (-1: not looked at) and number of edges.
    entry_*, edge_*, vector_*, log_* : arrays
    class_vector, class_point, class_log, class_default : (X,) int
        Heads of linked lists, and the vector for observations that were not looked at.
    corner : (N,) float
        Upper bound at each state.
    informed : (A, N) float
        The fast informed bound.
    table : (power of two,) int
        Hash table of beliefs.
    """

    used: np.ndarray
    node_class: np.ndarray
    node_start: np.ndarray
    node_length: np.ndarray
    node_upper: np.ndarray
    node_lower: np.ndarray
    node_best: np.ndarray
    node_vectors: np.ndarray
    node_logged: np.ndarray
    node_plane: np.ndarray
    node_next_point: np.ndarray
    choice_upper: np.ndarray
    choice_reward: np.ndarray
    choice_edge: np.ndarray
    choice_edges: np.ndarray
    entry_state: np.ndarray
    entry_chance: np.ndarray
    edge_chance: np.ndarray
    edge_child: np.ndarray
    edge_column: np.ndarray
    vector_class: np.ndarray
    vector_action: np.ndarray
    vector_start: np.ndarray
    vector_next: np.ndarray
    vector_number: np.ndarray
    log_node: np.ndarray
    log_next: np.ndarray
    class_vector: np.ndarray
    class_point: np.ndarray
    class_log: np.ndarray
    class_default: np.ndarray
    class_default_worth: np.ndarray
    corner: np.ndarray
    informed: np.ndarray
    table: np.ndarray
    mass: np.ndarray
    buffer: np.ndarray
    touched: np.ndarray
    ahead: np.ndarray
    ahead_stamp: np.ndarray
    slot_of: np.ndarray
    column_vector: np.ndarray
    column_stamp: np.ndarray
    stamp: np.ndarray

    @property
    def bytes_held(self) -> int:
        """Bytes of all arrays."""
        return sum(array.nbytes for array in self)


def new_search(flat: FlatModel, informed: Float[np.ndarray, "actions states"]) -> Search:
    """An empty search under a fast informed bound."""
    states, classes, actions = flat.size, len(flat.tables.class_start) - 1, len(flat.actions)
    nodes, many, none = 1 << 10, 1 << 14, np.full(classes, -1)
    whole, real = np.int64, np.float64
    finite = np.where(np.isfinite(informed), informed, -1e300)
    return Search(
        used=np.zeros(9, whole),
        node_class=np.empty(nodes, whole),
        node_start=np.empty(nodes, whole),
        node_length=np.empty(nodes, whole),
        node_upper=np.empty(nodes, real),
        node_lower=np.empty(nodes, real),
        node_best=np.empty(nodes, whole),
        node_vectors=np.empty(nodes, whole),
        node_logged=np.empty(nodes, whole),
        node_plane=np.empty(nodes, real),
        node_next_point=np.empty(nodes, whole),
        choice_upper=np.empty((nodes, actions), real),
        choice_reward=np.empty((nodes, actions), real),
        choice_edge=np.empty((nodes, actions), whole),
        choice_edges=np.empty((nodes, actions), whole),
        entry_state=np.empty(many, whole),
        entry_chance=np.empty(many, real),
        edge_chance=np.empty(many, real),
        edge_child=np.empty(many, whole),
        edge_column=np.empty(many, whole),
        vector_class=np.empty(nodes, whole),
        vector_action=np.empty(nodes, whole),
        vector_start=np.empty(nodes, whole),
        vector_next=np.empty(nodes, whole),
        vector_number=np.empty(many, real),
        log_node=np.empty(nodes, whole),
        log_next=np.empty(nodes, whole),
        class_vector=none.copy(),
        class_point=none.copy(),
        class_log=none.copy(),
        class_default=none.copy(),
        class_default_worth=np.full(classes, -np.inf),
        corner=informed.max(axis=0),
        informed=finite,
        table=np.full(1 << 12, -1),
        mass=np.zeros(states),
        buffer=np.zeros(states),
        touched=np.empty(states, whole),
        ahead=np.empty(states),
        ahead_stamp=np.zeros(states, whole),
        slot_of=np.full(flat.tables.columns, -1),
        column_vector=np.empty(flat.tables.columns, whole),
        column_stamp=np.zeros(flat.tables.columns, whole),
        stamp=np.zeros(1, whole),
    )


def grown(search: Search, needed: np.ndarray) -> Search:
    """The same search with room for ``needed`` more of everything."""
    changed: dict[str, np.ndarray] = {}
    for place, names in ((NODES, (*_NODE_SIZED, *_PER_ACTION)), *_SIZES.items()):
        held, least = len(getattr(search, names[0])), int(search.used[place] + needed[place])
        if least > held:
            size = max(least, held + held // 2)
            changed |= {name: _longer(getattr(search, name), size) for name in names}
    return search._replace(**changed)


def _longer(array: np.ndarray, size: int) -> np.ndarray:
    longer = np.empty((size, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer
