"""How loops are compiled: what Python calls is kept on disk, and what only compiled loops call is a part of them.

Compiling happens once on a machine, and the first user waits for it; so it is kept short. Parts have no face for
Python. Nothing is allocated in a loop, so that arrays need no counting of references (``_nrt``): room to work in is
handed in, and only numbers are returned. What is kept on disk is taken as long as the file of the function that Python
calls stands as it was: after a change to a part in another file, touch that one.
"""

from __future__ import annotations

from typing import Any

from numba import njit

__all__ = ["compiled", "part"]

_LEAN: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "no_cfunc_wrapper": True}
_INNER: dict[str, Any] = {**_LEAN, "no_cpython_wrapper": True}

compiled = njit(cache=True, **_LEAN)
part = njit(**_INNER)
