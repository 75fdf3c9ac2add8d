"""The automatic choice, and bounds of models that only their blocks can bound."""

from __future__ import annotations

from pathlib import Path

import pytest

import factored_pomdp as fp
from solvers import Auto, Exact, Limits, PointBased
from solvers import auto as auto_module
from solvers.block_bounds import block_bound


@pytest.mark.example
def test_chooses_and_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    tiger = fp.domain("tiger")
    found = Auto(tiger).solve(Limits(precision=0.1))
    assert found.solver == "point-based"
    assert found.notes[0].startswith("point-based: no horizon")
    assert Auto(tiger).solve(Limits(horizon=2)).solver == "exact"
    monkeypatch.setattr(auto_module, "_FEW_STATES", 1)
    found = Auto(tiger).solve(Limits(horizon=2))
    assert found.solver == "fib"
    assert "too many for exact vectors" in found.notes[0]
    with pytest.raises(ValueError, match="give a horizon"):
        Auto(fp.domain("tiger", discount=1.0)).solve()


@pytest.mark.example
def test_blocks_bound_from_above() -> None:
    """Three machines are three times one machine, and no more than their blocks' bounds."""
    one = PointBased(fp.domain("machine-repair", machines=1)).solve(Limits(precision=0.01))
    bound, notes = block_bound(fp.domain("machine-repair", machines=3), None, seconds=3.0)
    assert 3 * one.lower <= bound <= 3 * one.upper + 0.3
    assert notes == ("3 block(s) bounded by point-based search on it alone",)
    bound, notes = block_bound(fp.domain("machine-repair", machines=3), 4)
    exact = Exact(fp.domain("machine-repair", machines=1)).solve(Limits(horizon=4))
    assert 3 * exact.lower <= bound + 1e-9
    assert notes == ("3 block(s) bounded by the fast informed bound",)


@pytest.mark.example
def test_too_large_to_flatten_but_decomposes() -> None:
    many = fp.domain("machine-repair", machines=16)
    assert not PointBased.can_solve(many)
    assert Auto.can_solve(many)
    found = Auto(many).solve(Limits(horizon=2, time_limit=0.01))
    # Two steps of good machines earn 16 · 1.95 at the most, and little less on average.
    assert 29 < found.lower < found.upper <= 16 * 1.95 + 1e-9
    assert found.lower_is == "statistical"
    assert found.policy is None
    with pytest.raises(ValueError, match="no policy"):
        found.save(Path("policy.npz"))
    assert not Auto.can_solve(fp.domain("machine-repair", machines=16, coupled=True))


@pytest.mark.example
def test_known_variables_go_with_the_blocks_that_read_them() -> None:
    tiny = fp.domain("surveillance", site="tiny", targets=3)
    bound, notes = block_bound(tiny, 5)
    # Each of three targets is seen at most once a step.
    assert 0 < bound <= 15 + 1e-9
    assert sum(int(note.split()[0]) for note in notes) == 3
