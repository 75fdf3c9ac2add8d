"""Where an answer comes from: command, version, seed, and a digest of what went in."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from factored_pomdp.factors import Factor
    from factored_pomdp.model import FactoredPOMDP

__all__ = ["digest", "provenance"]

_DIGESTS: WeakKeyDictionary[FactoredPOMDP, str] = WeakKeyDictionary()


def provenance(command: str, inputs: Mapping[str, str], seed: int | None = None) -> dict[str, Any]:
    """What every answer carries.

    Parameters
    ----------
    command : str
        As it could be typed again.
    inputs : mapping
        Name of each input to the digest of its content.
    seed : int, optional
        Left out where nothing was drawn at random.
    """
    from factored_pomdp import __version__

    return {"command": command, "version": __version__, "inputs": dict(inputs), "seed": seed}


def digest(model: FactoredPOMDP) -> str:
    """SHA-256 over a model's variables and numbers; kept for each model, factors that share arrays are hashed once."""
    if model not in _DIGESTS:
        found = hashlib.sha256()
        tables: dict[tuple[Any, ...], bytes] = {}
        for kind in ("states", "actions", "observations"):
            described = [(variable.name, variable.values) for variable in getattr(model, kind)]
            found.update(repr((kind, described)).encode())
        rest = (float(model.discount), sorted(model.declared_known), model.groups)
        found.update(repr(rest).encode())
        for kind in ("initial", "transition", "observation", "reward", "legal"):
            for name, factor in getattr(model, kind).items():
                found.update(repr((kind, name, factor.names)).encode())
                found.update(_of_table(factor, tables))
        if model.terminal is not None:
            found.update(repr(("terminal", model.terminal.names)).encode())
            found.update(_of_table(model.terminal, tables))
        _DIGESTS[model] = f"sha256:{found.hexdigest()}"
    return _DIGESTS[model]


def _of_table(factor: Factor, known: dict[tuple[Any, ...], bytes]) -> bytes:
    from factored_pomdp.factors import DenseFactor, DeterministicFactor, NoisyOr, SparseFactor

    key = (*factor.storage, *(variable.size for variable in factor.scope))
    if key not in known:
        found = hashlib.sha256(type(factor).__name__.encode())
        if isinstance(factor, DenseFactor):
            arrays = [factor.array]
        elif isinstance(factor, SparseFactor):
            arrays = [factor.coordinates, factor.numbers]
        elif isinstance(factor, DeterministicFactor):
            arrays = [factor.indexes]
        elif isinstance(factor, NoisyOr):
            found.update(repr(factor.off_index).encode())
            emissions = [cause.emission.tocsr() for cause in factor.causes]
            arrays = [part for e in emissions for part in (e.indptr, e.indices, e.data)]
            arrays += [cause.activation for cause in factor.causes]
        else:
            arrays = [factor.dense().array]
        for array in arrays:
            found.update(repr((array.dtype.kind, array.shape)).encode())
            found.update((array.astype("<i8") if array.dtype.kind in "iu" else array.astype("<f8")).tobytes())
        known[key] = found.digest()
    return known[key]
