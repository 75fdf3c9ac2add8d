"""A first call that waits for the compiler says so, once; the next one does not."""

from __future__ import annotations

import pytest
from numba import njit

from factored_pomdp.commands.compiling import compiling_told


@pytest.mark.example
def test_only_what_is_compiled_is_told_and_only_once(capsys: pytest.CaptureFixture[str]) -> None:
    one, other = njit(lambda number: number + 1), njit(lambda number: number + 2)
    with compiling_told():
        assert (one(1), other(1)) == (2, 3)
    told = capsys.readouterr()
    assert told.err == "compiling loops, once on this machine …\n"
    assert told.out == ""
    with compiling_told():
        assert (one(2), other(2)) == (3, 4)
    assert njit(lambda number: number + 3)(1) == 4
    assert capsys.readouterr().err == ""
