"""Policies on disk: what comes back decides the same; another model's is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp
from solvers import FIB, MDP, Exact, Limits, PointBased
from solvers.policy_files import load_policy


@pytest.mark.example
@pytest.mark.parametrize("solver", [PointBased, Exact, FIB, MDP])
def test_decides_the_same(solver: type, tmp_path: Path) -> None:
    model = fp.domain("tiger")
    limits = Limits(precision=0.1, horizon=3 if solver is Exact else None)
    solution = solver(model).solve(limits)
    solution.save(tmp_path / "tiger.npz")
    read = load_policy(tmp_path / "tiger.npz", fp.domain("tiger"))
    for left in np.linspace(0, 1, 11):
        belief = np.array([left, 1 - left])
        assert read.decide(belief) == solution.policy.decide(belief)
    assert [path.name for path in tmp_path.iterdir()] == ["tiger.npz"]


@pytest.mark.example
def test_refuses_what_is_no_policy_of_this_model(tmp_path: Path) -> None:
    path = tmp_path / "tiger.npz"
    PointBased(fp.domain("tiger")).solve(Limits(precision=1.0)).save(path)
    with pytest.raises(ValueError, match="policy of another model"):
        load_policy(path, fp.domain("tiger", accuracy=0.8))
    path.write_bytes(path.read_bytes()[:300])
    with pytest.raises(ValueError, match=r"tiger\.npz: not a policy file"):
        load_policy(path, fp.domain("tiger"))
    with pytest.raises(ValueError, match="no such file"):
        load_policy(tmp_path / "missing.npz", fp.domain("tiger"))
