"""What can be wrong with a disk; it must keep nobody from watching, nor from sending cameras home."""

from __future__ import annotations

import errno

__all__ = ["disk_fails", "said"]

_FAILURES = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO})


def disk_fails(problem: OSError) -> bool:
    """Whether the disk is full, may only be read, or is broken; anything else is a matter of what was asked for."""
    return problem.errno in _FAILURES


def said(problem: OSError) -> str:
    """Such as ``cameras/4f2a.held: no space left on device``."""
    where = f"{problem.filename}: " if problem.filename else ""
    return where + (problem.strerror or str(problem)).lower()
