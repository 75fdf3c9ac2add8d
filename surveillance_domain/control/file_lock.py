"""Locks on files, which a process holds for as long as it lives.

A lock needs no room on the disk; only who holds it does, which is written into the file where that is possible.
Otherwise the kernel's own list, ``/proc/locks``, says who. A process that is killed leaves there what it wrote.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

__all__ = ["Before", "is_locked", "locked", "shared"]

_MOST_BYTES = 4096
_KERNELS = Path("/proc/locks")


class Before(NamedTuple):
    """Who had locked a file before.

    Attributes
    ----------
    holder : str
        Who still has; empty: nobody, so that it is ours now.
    killed : str
        Who had it last, if they were killed.
    """

    holder: str
    killed: str


@contextmanager
def locked(path: Path, told: str) -> Iterator[Before]:
    """Lock a file for oneself, and write into it who did, unless it is locked already.

    Raises
    ------
    OSError
        If it can be neither made nor read, or if there are no locks on its file system; naming the file.
    """
    file = _opened(path)
    try:
        if not _lock(file, path, fcntl.LOCK_EX | fcntl.LOCK_NB):
            yield Before(_holder(file), "")
            return
        killed = ""
        with suppress(OSError):
            written = _written(file)
            os.ftruncate(file, 0)
            killed = written
            os.pwrite(file, told.encode(), 0)
        try:
            yield Before("", killed)
        finally:
            with suppress(OSError):
                os.ftruncate(file, 0)
    finally:
        os.close(file)


@contextmanager
def shared(path: Path) -> Iterator[None]:
    """Lock a file together with others who do so by this function.

    Raises
    ------
    OSError
        As `locked` does.
    """
    file = _opened(path)
    try:
        _lock(file, path, fcntl.LOCK_SH)
        yield
    finally:
        os.close(file)


def is_locked(path: Path) -> bool:
    """Whether somebody has locked a file, in either way, as far as that can be asked."""
    with suppress(OSError):
        file = os.open(path, os.O_RDONLY)
        try:
            return not _lock(file, path, fcntl.LOCK_EX | fcntl.LOCK_NB)
        finally:
            os.close(file)
    return False


def _opened(path: Path) -> int:
    """Where the disk may only be read, a file that is there already can be locked all the same."""
    try:
        return os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
    except OSError as problem:
        try:
            return os.open(path, os.O_RDONLY)
        except FileNotFoundError:
            raise problem from None


def _lock(file: int, path: Path, how: int) -> bool:
    try:
        fcntl.flock(file, how)
    except BlockingIOError:
        return False
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, str(path)) from None
    return True


def _holder(file: int) -> str:
    return _written(file) or _by_the_kernel(os.fstat(file)) or "an unknown process"


def _written(file: int) -> str:
    return os.pread(file, _MOST_BYTES, 0).decode(errors="replace").strip()


def _by_the_kernel(status: os.stat_result) -> str:
    """Such as ``process 4892``; empty if it does not tell."""
    here = f"{os.major(status.st_dev):02x}:{os.minor(status.st_dev):02x}:{status.st_ino}"
    with suppress(OSError):
        for line in _KERNELS.read_text(encoding="utf-8").splitlines():
            words = line.split()  # 1: FLOCK ADVISORY WRITE 4892 00:2f:1234 0 EOF
            if words[1:2] == ["FLOCK"] and words[5:6] == [here]:
                return f"process {words[4]}"
    return ""
