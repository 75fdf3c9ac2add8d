"""Every model file that lies beside the repository loads, and survives being written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import factored_pomdp as fp
from factored_pomdp.provenance import digest
from tests.factored_pomdp.files.test_round_trips import again

FOLDER = Path(__file__).parents[3] / ".." / "shared" / "data" / "pomdp"
FILES = sorted(path for path in FOLDER.glob("*/*") if path.suffix.lower() in (".pomdp", ".pomdpx"))

pytestmark = pytest.mark.skipif(not FILES, reason="the shared model files are not beside the repository")

SIZES = {
    "1d": (4, 2, 2, 0.75),
    "4x3.95": (11, 4, 6, 0.95),
    "bridge-repair": (5, 12, 5, 1.0),
    "learning.c2": (12, 8, 3, 0.99),
    "machine": (256, 4, 16, 0.999),
    "mini-hall2": (13, 3, 9, 0.95),
    "parr95.95": (7, 3, 6, 0.95),
    "query.s2": (9, 2, 3, 0.99),
    "rockSample-3_1": (6, 4, 2, 0.95),
    "uav-search.raissa-bravo.orig": (8, 8, 2, 0.95),
}


@pytest.mark.end_to_end
@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_loads_and_comes_back(path: Path, tmp_path: Path) -> None:
    model = fp.load(path)
    if model.name in SIZES:
        found = (model.joint_states, model.joint_actions, model.joint_observations, model.discount)
        assert found == SIZES[model.name]
    assert digest(again(model, tmp_path / "factored.pomdpx")) == digest(model)
    flat = again(model, tmp_path / "flat.pomdp")
    there = again(flat, tmp_path / "there.pomdpx")
    assert digest(again(there, tmp_path / "back.pomdp")) == digest(there) == digest(flat)
    one, other = fp.joint(model), fp.joint(flat)
    np.testing.assert_allclose(other.reward, one.reward, atol=1e-12)
    for action in range(len(one.actions)):
        assert abs(other.transition[action] - one.transition[action]).max() <= 1e-12
        assert abs(other.observation[action] - one.observation[action]).max() <= 1e-12


@pytest.mark.example
def test_costs_and_starts_of_the_shared_files() -> None:
    bridge = fp.load(FOLDER / "cassandra" / "bridge-repair.POMDP")
    assert fp.joint(bridge).reward.max() <= 0
    parr = fp.joint(fp.load(FOLDER / "cassandra" / "parr95.95.POMDP"))
    assert parr.initial.tolist() == [1, 0, 0, 0, 0, 0, 0]
    learning = fp.joint(fp.load(FOLDER / "cassandra" / "learning.c2.pomdp"))
    assert np.flatnonzero(learning.initial).tolist() == [0, 4, 8]
    maze = fp.load(FOLDER / "cassandra" / "1d.POMDP")
    assert any("2 of 8 distributions renormalised (worst sum 0.999999" in note for note in maze.notes)


@pytest.mark.example
def test_the_same_problem_in_both_formats() -> None:
    for name in ("Hallway", "Tiger"):
        flat = fp.joint(fp.load(FOLDER / "cassandra" / f"{name}.pomdp"))
        xml = fp.joint(fp.load(FOLDER / "pomdpx" / f"{name}.pomdpx"))
        np.testing.assert_allclose(xml.initial, flat.initial, atol=1e-9)
        for action in range(len(flat.actions)):
            assert abs(xml.transition[action] - flat.transition[action]).max() < 1e-9
            assert abs(xml.observation[action] - flat.observation[action]).max() < 1e-9
        np.testing.assert_allclose(xml.reward, flat.reward, atol=1e-6)
