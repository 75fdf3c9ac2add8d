"""Policies on disk: one ``.npz`` file with every number and the digest of the model that they are for.

Nothing in the file is run or unpickled; a policy of another model is refused.
"""

from __future__ import annotations

import json
import os
import zipfile
from pathlib import Path
from typing import Any, get_args

import numpy as np

from factored_pomdp.model import FactoredPOMDP
from factored_pomdp.provenance import digest
from solvers.alpha_vectors import VectorSet
from solvers.flat import FlatModel, flatten
from solvers.policy import Follows, Stage, VectorPolicy
from solvers.sawtooth import Sawtooth

__all__ = ["load_policy", "save_policy"]

_FORMAT = "factored-pomdp policy 1"


def save_policy(policy: VectorPolicy, path: str | Path) -> None:
    """Write a policy; the file is there in full or not at all."""
    header = {
        "format": _FORMAT,
        "model": digest(policy.flat.model),
        "name": policy.flat.model.name,
        "solver": policy.solver,
        "follows": policy.follows,
        "horizon": policy.horizon,
        "stages": len(policy.stages),
        "per_state": [stage.per_state for stage in policy.stages],
    }
    arrays: dict[str, Any] = {"header": np.array(json.dumps(header))}
    for number, stage in enumerate(policy.stages):
        arrays |= {f"{number}.{name}": array for name, array in _arrays(stage).items()}
    path = Path(path)
    beside = path.with_name(path.name + ".part")
    try:
        with beside.open("wb") as file:
            np.savez_compressed(file, **arrays)
        os.replace(beside, path)
    finally:
        beside.unlink(missing_ok=True)


def load_policy(path: str | Path, model: FactoredPOMDP) -> VectorPolicy:
    """Read a policy for a model.

    Raises
    ------
    ValueError
        Naming the file: it is no policy, or one of another model.
    """
    path = Path(path)
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as content:
            arrays = {name: content[name] for name in content.files}
        header = json.loads(str(arrays["header"]))
        is_policy = header.get("format") == _FORMAT
    except (zipfile.BadZipFile, KeyError, ValueError, OSError, AttributeError, EOFError) as problem:
        if isinstance(problem, FileNotFoundError):
            raise ValueError(f"{path}: no such file") from None
        raise ValueError(f"{path}: not a policy file; expected one that `solve --out` wrote") from problem
    if not is_policy:
        raise ValueError(f"{path}: found format {header.get('format')!r}; expected {_FORMAT!r}")
    if header["model"] != digest(model):
        raise ValueError(
            f"{path}: a policy of another model ({header['name']}, {header['model'][:19]}…); {model.name} as given "
            f"here is {digest(model)[:19]}…; solve it anew"
        )
    try:
        flat = flatten(model)
        stages = tuple(
            _stage(flat, {name.partition(".")[2]: array for name, array in arrays.items() if _is_of(name, number)},
                   bool(header["per_state"][number]))
            for number in range(header["stages"])
        )  # fmt: skip
        if header["follows"] not in get_args(Follows) or not stages:
            raise ValueError(f"found a policy that follows {header['follows']!r}")
    except (KeyError, TypeError, IndexError, ValueError) as problem:
        raise ValueError(f"{path}: damaged ({problem}); solve the model anew") from problem
    return VectorPolicy(flat, str(header["solver"]), stages, header["follows"], header["horizon"])


def _is_of(name: str, number: int) -> bool:
    return name.partition(".")[0] == str(number)


def _arrays(stage: Stage) -> dict[str, np.ndarray]:
    found = {"classes": stage.lower.classes, "actions": stage.lower.actions, "values": stage.lower.values}
    if stage.upper is not None:
        found["upper"] = stage.upper
    if stage.sawtooth is not None:
        names = ("corner", "classes", "start", "states", "chances", "values")
        found |= {f"sawtooth.{name}": getattr(stage.sawtooth, name) for name in names}
    return found


def _stage(flat: FlatModel, arrays: dict[str, np.ndarray], per_state: bool) -> Stage:
    sizes = np.diff(flat.tables.class_start)[arrays["classes"]]
    if sizes.sum() != len(arrays["values"]) or len(arrays["actions"]) != len(sizes):
        raise ValueError("vectors of another length than their states")
    if len(sizes) and not 0 <= arrays["actions"].min() <= arrays["actions"].max() < len(flat.actions):
        raise ValueError("actions that the model does not have")
    lower = VectorSet(arrays["classes"], arrays["actions"], arrays["values"], flat.tables.class_start)
    parts = {name.partition(".")[2]: array for name, array in arrays.items() if name.startswith("sawtooth.")}
    return Stage(lower, arrays.get("upper"), Sawtooth(**parts) if parts else None, per_state)
