"""Compiled loops are kept on disk for the next start; a disk that fails costs only the time to compile them again."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from typing import Any

__all__ = ["kept_if_possible"]


@contextmanager
def kept_if_possible() -> Iterator[None]:
    """In here, what numba cannot keep is used all the same; to be entered before loops are loaded.

    Numba takes a full disk for an error of whoever called the function, and one that may only be read for an error of
    whoever declared it. There is no setting for that, so the one method that writes is wrapped; and a folder that
    ``NUMBA_CACHE_DIR`` names, but that cannot be written to, is replaced by a temporary one.
    """
    import numba
    from numba.core import caching

    writer: Any = caching.Cache
    settings: Any = numba.config
    before, folder = writer.save_overload, settings.CACHE_DIR

    def save(cache: Any, signature: Any, data: Any) -> None:
        with suppress(OSError):
            before(cache, signature, data)

    with ExitStack() as stack:
        if folder and not _may_be_written(folder):
            with suppress(OSError):
                settings.CACHE_DIR = stack.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        writer.save_overload = save
        try:
            yield
        finally:
            writer.save_overload, settings.CACHE_DIR = before, folder


def _may_be_written(folder: str) -> bool:
    """Whether files can be made there; they need not have room."""
    try:
        os.makedirs(folder, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return True
    except OSError:
        return False
