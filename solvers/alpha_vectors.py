"""Alpha vectors: linear functions of a belief, each with the action that it begins with.

A set of them stands for the convex function ``V(b) = max_α α · b`` (Smallwood and Sondik 1973). A vector is held over
the states of one class only (`solvers.flat`).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from jaxtyping import Bool, Float, Int

from solvers.flat import FlatModel

__all__ = ["VectorSet", "undominated"]


@dataclass(frozen=True, eq=False)
class VectorSet:
    """Alpha vectors of all classes.

    Attributes
    ----------
    classes : (K,) int
        The class that each vector is about.
    actions : (K,) int
        Joint action that it begins with.
    values : (total,) float
        The vectors one after the other, each as long as its class has states.
    class_start : (X + 1,) int
        First state of each class.
    """

    classes: Int[np.ndarray, " vectors"]
    actions: Int[np.ndarray, " vectors"]
    values: Float[np.ndarray, " total"]
    class_start: Int[np.ndarray, " classes_and_one"]

    @classmethod
    def of(cls, flat: FlatModel, parts: dict[int, tuple[np.ndarray, np.ndarray]]) -> VectorSet:
        """From ``{class: (vectors (K, n), actions (K,))}``."""
        classes = [np.full(len(actions), number) for number, (_, actions) in parts.items()]
        return cls(
            np.concatenate([np.empty(0, np.int64), *classes]),
            np.concatenate([np.empty(0, np.int64), *(actions for _, actions in parts.values())]),
            np.concatenate([np.empty(0), *(np.asarray(vectors, float).ravel() for vectors, _ in parts.values())]),
            flat.tables.class_start,
        )

    @classmethod
    def everywhere(
        cls, flat: FlatModel, vectors: Float[np.ndarray, "k states"], actions: Int[np.ndarray, "k states"]
    ) -> VectorSet:
        """From vectors over all states, an action being the same within a class."""
        starts = flat.tables.class_start
        parts = {}
        for number, (first, past) in enumerate(pairwise(starts)):
            keep = undominated(vectors[:, first:past])
            parts[number] = vectors[keep, first:past], actions[keep, first]
        return cls.of(flat, parts)

    def __len__(self) -> int:
        return len(self.classes)

    @cached_property
    def _places(self) -> tuple[Int[np.ndarray, " vectors"], dict[int, Int[np.ndarray, " some"]]]:
        sizes = np.diff(self.class_start)[self.classes]
        order = np.argsort(self.classes, kind="stable")
        numbers, first = np.unique(self.classes[order], return_index=True)
        members = np.split(order, first[1:])
        return np.cumsum(sizes) - sizes, dict(zip(numbers.tolist(), members, strict=True))

    def has(self, number: int) -> bool:
        """Whether there are vectors of a class."""
        return number in self._places[1]

    def of_class(self, number: int) -> tuple[Float[np.ndarray, "k states"], Int[np.ndarray, " k"]]:
        """Vectors of one class (over its own states) and their actions."""
        starts, members = self._places
        size = int(self.class_start[number + 1] - self.class_start[number])
        chosen = members.get(number, np.empty(0, np.int64))
        rows = self.values[starts[chosen][:, None] + np.arange(size)]
        return rows, self.actions[chosen]

    def best(self, belief: Float[np.ndarray, " states"], number: int) -> tuple[float, int]:
        """``max α · b`` over a class's vectors, and the action of the best."""
        vectors, actions = self.of_class(number)
        worth = vectors @ belief[self.class_start[number] : self.class_start[number + 1]]
        best = int(worth.argmax())
        return float(worth[best]), int(actions[best])


def undominated(vectors: Float[np.ndarray, "k states"], slack: float = 0.0) -> Bool[np.ndarray, " k"]:
    """Which vectors are not below another one everywhere; of equals the first stays. Time: k² n."""
    from solvers.dominance import undominated_rows

    order = np.argsort(-vectors.sum(axis=1), kind="stable")
    return np.asarray(undominated_rows(np.ascontiguousarray(vectors, dtype=float), order, slack))
