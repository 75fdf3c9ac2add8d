"""Algorithms, one a file. Every solver answers ``can_solve`` and decides with a `Decision`."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from solvers.auto import Auto
    from solvers.base import Ability, Decision
    from solvers.exact import Exact
    from solvers.lookahead import Lookahead
    from solvers.maximise import maximise
    from solvers.mdp import MDP
    from solvers.myopic import DecomposedMyopic
    from solvers.myopic_joint import JointMyopic
    from solvers.point_based import PointBased
    from solvers.solution import Limits, Progress, Solution
    from solvers.sparse_sampling import SparseSampling
    from solvers.upper_bounds import FIB, QMDP

_HOME_OF = {
    "Ability": "base",
    "Auto": "auto",
    "Decision": "base",
    "DecomposedMyopic": "myopic",
    "Exact": "exact",
    "FIB": "upper_bounds",
    "JointMyopic": "myopic_joint",
    "Limits": "solution",
    "Lookahead": "lookahead",
    "MDP": "mdp",
    "PointBased": "point_based",
    "Progress": "solution",
    "QMDP": "upper_bounds",
    "Solution": "solution",
    "SparseSampling": "sparse_sampling",
    "maximise": "maximise",
}

__all__ = sorted(_HOME_OF)


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'solvers' has no attribute {name!r}")
    return getattr(import_module(f"solvers.{_HOME_OF[name]}"), name)
