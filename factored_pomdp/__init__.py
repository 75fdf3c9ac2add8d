"""Factored partially observable Markov decision processes: define, decompose, believe.

Names are loaded on first use, so that importing this package costs nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from factored_pomdp.beliefs import JointBelief, ProductBelief, initial_belief
    from factored_pomdp.contraction import contract
    from factored_pomdp.decomposition import Certificate, decompose
    from factored_pomdp.errors import Fault, ImpossibleObservation, ModelError, TooLarge
    from factored_pomdp.expansion import Joint, joint
    from factored_pomdp.factors import Cause, DenseFactor, DeterministicFactor, Factor, NoisyOr, SparseFactor
    from factored_pomdp.files import FileError, load, save
    from factored_pomdp.model import FactoredPOMDP
    from factored_pomdp.registry import domain, solvers
    from factored_pomdp.simulation import Simulation
    from factored_pomdp.specification import table
    from factored_pomdp.variables import Variable

_HOMES = {
    "beliefs": ["JointBelief", "ProductBelief", "initial_belief"],
    "contraction": ["contract"],
    "decomposition": ["Certificate", "decompose"],
    "errors": ["Fault", "ImpossibleObservation", "ModelError", "TooLarge"],
    "expansion": ["Joint", "joint"],
    "factors": ["Cause", "DenseFactor", "DeterministicFactor", "Factor", "NoisyOr", "SparseFactor"],
    "files": ["FileError", "load", "save"],
    "model": ["FactoredPOMDP"],
    "registry": ["domain", "solvers"],
    "simulation": ["Simulation"],
    "specification": ["table"],
    "variables": ["Variable"],
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = sorted(_HOME_OF)
__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'factored_pomdp' has no attribute {name!r}")
    return getattr(import_module(f"factored_pomdp.{_HOME_OF[name]}"), name)
