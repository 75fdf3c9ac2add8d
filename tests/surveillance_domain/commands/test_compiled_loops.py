"""A disk on which compiled loops cannot be kept."""

from __future__ import annotations

import errno
from pathlib import Path
from typing import Any

import numba
import pytest
from numba.core import caching

from surveillance_domain.commands.compiled_loops import kept_if_possible


def _full(cache: Any, path: str) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def _loop(number: int) -> int:
    return number + 1


@pytest.mark.example
def test_what_finds_no_room_is_compiled_and_used(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "kept"))
    monkeypatch.setattr(caching.IndexDataCacheFile, "_open_for_write", _full)
    with kept_if_possible():
        assert numba.njit(cache=True)(_loop)(2) == 3
    with pytest.raises(OSError, match="No space left"):  # as numba does by itself
        numba.njit(cache=True)(_loop)(2)


@pytest.mark.example
def test_a_folder_that_cannot_be_made_is_replaced_for_the_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    refused = str(tmp_path / "file" / "kept")
    monkeypatch.setattr(numba.config, "CACHE_DIR", refused)
    with kept_if_possible():
        instead = Path(numba.config.CACHE_DIR)
        assert numba.njit(cache=True)(_loop)(2) == 3
        assert list(instead.rglob("*.nbi"))
    assert refused == numba.config.CACHE_DIR
    assert not instead.exists()
