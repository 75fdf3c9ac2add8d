"""One sparse linear step of a prediction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

__all__ = ["Operator"]


@dataclass(frozen=True, eq=False)
class Operator:
    """A sparse linear map between belief arrays, rows in CSR form."""

    indptr: np.ndarray
    indices: np.ndarray
    data: np.ndarray
    states: int
