"""Arrays of the point-based search: belief nodes, what follows them, alpha vectors, the log of upper bounds.

Everything lives in flat arrays of records that compiled loops read and write (``search.nodes[n].upper``) and that grow
by copying. They are few: each one costs compiling time wherever the search is handed on.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from solvers.alpha_vectors import VectorSet
from solvers.flat import FlatModel

__all__ = ["Search", "grown", "new_count", "new_search"]


def _record(whole: str = "", real: str = "") -> np.dtype:
    """A record of 64-bit whole numbers and 64-bit real ones."""
    return np.dtype([*((name, np.int64) for name in whole.split()), *((name, np.float64) for name in real.split())])


_COUNT = _record("nodes entries edges vectors numbers logged points work stamp")
_NODE = _record("kind start length best vectors logged next_point", "upper lower plane")
_CHOICE = _record("edge edges", "upper reward")
_ENTRY = _record("state", "chance")
_EDGE = _record("child column", "chance")
_VECTOR = _record("action start next")
_LOG = _record("node next")
_KIND = _record("vector point log default", "default_worth")
_STATE = _record("touched stamp", "corner mass ahead")
_COLUMN = _record("slot vector stamp")
_SLOT = _record("column length place", "mass")
_DEEPEST = 1000
"""Steps that a trial goes down at the most."""
_GROWING = {
    "nodes": ("nodes", "choices"),
    "entries": ("entries",),
    "edges": ("edges",),
    "vectors": ("vectors",),
    "numbers": ("numbers",),
    "logged": ("log",),
}


class Search(NamedTuple):
    """The state of a search.

    Attributes
    ----------
    used : (1,) record
        Used lengths; the work that was done; a stamp that is never used twice.
    nodes : (nodes,) records
        Class of a belief ("kind") and its place among the entries; its best vector; how many vectors and log entries
        its bounds have seen; the next point of its class (-2: no point); both bounds; the plane of the corners.
    choices : (nodes, A) records
        First edge of an action (-1: not looked at) and their number; its upper bound, and its expected reward.
    entries : (entries,) records
        States and their chances, belief by belief.
    edges : (edges,) records
        An observation that may follow: the belief then, the observation's column, its chance.
    vectors : (vectors,) records
        An alpha vector's action, its place among the numbers, the next one of its class.
    numbers : (numbers,) float
    log : (logged,) records
        A point whose upper bound fell, and the entry before it in the log of its class.
    kinds : (X,) records
        Heads of the lists of a class; the vector for observations that were not looked at, and the sum of its numbers.
    states : (N,) records
        Upper bound at a state ("corner"); its mass in an expansion; what lies ahead of it in a backup, and which backup
        that was. ``touched`` lists the states that have mass.
    columns : (Z,) records
        Slot of an observation in an expansion (-1: none); the vector that a backup takes for it, and which backup.
    slots : (Z,) records
        The observations of an expansion: entries of each, the next one's place, and their mass.
    informed : (A, N) float
        The fast informed bound.
    buffer : (N,) float
        A belief, spread out.
    looked : (A,) int
        Which actions a backup has looked at, by its stamp.
    path : (steps,) int
        Nodes of a trial; the root is the first.
    table : (power of two,) int
        Hash table of beliefs.
    """

    used: np.ndarray
    nodes: np.ndarray
    choices: np.ndarray
    entries: np.ndarray
    edges: np.ndarray
    vectors: np.ndarray
    numbers: np.ndarray
    log: np.ndarray
    kinds: np.ndarray
    states: np.ndarray
    columns: np.ndarray
    slots: np.ndarray
    informed: np.ndarray
    buffer: np.ndarray
    looked: np.ndarray
    path: np.ndarray
    table: np.ndarray

    @property
    def bytes_held(self) -> int:
        """Bytes of all arrays."""
        return sum(array.nbytes for array in self)


def new_count() -> np.ndarray:
    """One record of lengths, all zero."""
    return np.zeros(1, _COUNT)


def new_search(flat: FlatModel, informed: Float[np.ndarray, "actions states"], vectors: VectorSet) -> Search:
    """A search that knows a fast informed bound, first alpha vectors, and the initial belief's entries."""
    classes, actions = len(flat.tables.class_start) - 1, len(flat.actions)
    some, many = 1 << 10, 1 << 14
    kinds, states = np.full(classes, -1, _KIND), np.zeros(flat.size, _STATE)
    columns, slots = np.zeros(flat.tables.columns, _COLUMN), np.empty(flat.tables.columns, _SLOT)
    kinds["default_worth"], states["corner"], columns["slot"] = -np.inf, informed.max(axis=0), -1
    search = Search(
        used=new_count(),
        nodes=np.empty(some, _NODE),
        choices=np.empty((some, actions), _CHOICE),
        entries=np.empty(many, _ENTRY),
        edges=np.empty(many, _EDGE),
        vectors=np.empty(some, _VECTOR),
        numbers=np.empty(many),
        log=np.empty(some, _LOG),
        kinds=kinds,
        states=states,
        columns=columns,
        slots=slots,
        informed=np.where(np.isfinite(informed), informed, -1e300),
        buffer=np.zeros(flat.size),
        looked=np.zeros(actions, np.int64),
        path=np.zeros(_DEEPEST, np.int64),
        table=np.full(1 << 12, -1),
    )
    support, needed = np.flatnonzero(flat.initial), new_count()
    needed["vectors"], needed["numbers"], needed["entries"] = (
        len(vectors) + 1,
        len(vectors.values) + 1,
        len(support) + 1,
    )
    search = grown(search, needed)
    search.entries["state"][: len(support)], search.entries["chance"][: len(support)] = support, flat.initial[support]
    return _with_vectors(search, vectors)


def _with_vectors(search: Search, vectors: VectorSet) -> Search:
    """The search with its first vectors, of which none is below another of its class."""
    sizes = np.diff(vectors.class_start)[vectors.classes]
    starts = np.cumsum(sizes) - sizes
    rows = zip(vectors.classes, vectors.actions, starts, sizes, strict=True)
    for new, (number, action, start, size) in enumerate(rows):
        kind, worth = search.kinds[number], sum(vectors.values[start : start + size])
        search.vectors[new] = action, start, kind["vector"]
        kind["vector"] = new
        if worth > kind["default_worth"]:
            kind["default_worth"], kind["default"] = worth, new
    search.numbers[: len(vectors.values)] = vectors.values
    search.used["vectors"], search.used["numbers"] = len(vectors), len(vectors.values)
    return search


def grown(search: Search, needed: np.ndarray) -> Search:
    """The same search with room for ``needed`` more of everything."""
    changed: dict[str, np.ndarray] = {}
    for count, names in _GROWING.items():
        held, least = len(getattr(search, names[0])), int(search.used[count][0] + needed[count][0])
        if least > held:
            size = max(least, held + held // 2)
            changed |= {name: _longer(getattr(search, name), size) for name in names}
    return search._replace(**changed)


def _longer(array: np.ndarray, size: int) -> np.ndarray:
    longer = np.empty((size, *array.shape[1:]), array.dtype)
    longer[: len(array)] = array
    return longer
