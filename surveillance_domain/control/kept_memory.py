"""Who was moved by somebody, kept in files from one process to the next."""

from __future__ import annotations

import json
import math
import os
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

from surveillance_domain.cameras.base import Position
from surveillance_domain.world.memory import Memory, Stood

__all__ = ["KeptMemory", "replaced"]


class KeptMemory(Memory):
    """Of one camera, in a file under each of its addresses, as ``pan``, ``tilt``, ``zoom`` and ``still_since``.

    That is seconds since 1970, for it must outlive a restart of the machine. Clocks jump: a time that is still to come
    counts as now.

    Parameters
    ----------
    paths : sequence of Path
    wall : callable, optional
        The time, in seconds since 1970.
    """

    def __init__(self, paths: Sequence[Path], wall: Callable[[], float] = time.time) -> None:
        self._paths, self._wall = tuple(paths), wall

    def recall(self) -> Stood | None:
        found = [stood for stood in map(self._read, self._paths) if stood is not None]
        return min(found, key=lambda stood: stood.still_s, default=None)

    def keep(self, stood: Stood | None) -> None:
        """A disk that is full must not stop a watch: then the next one does not know."""
        for path in self._paths:
            with suppress(OSError):
                if stood is None:
                    path.unlink(missing_ok=True)
                else:
                    at = stood.position
                    since = self._wall() - stood.still_s
                    replaced(path, json.dumps({"pan": at.pan, "tilt": at.tilt, "zoom": at.zoom, "still_since": since}))

    def _read(self, path: Path) -> Stood | None:
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
            pan, tilt, since = (float(content[key]) for key in ("pan", "tilt", "still_since"))
            zoom = None if content["zoom"] is None else float(content["zoom"])
        except (OSError, ValueError, TypeError, KeyError):
            return None
        if not all(map(math.isfinite, (pan, tilt, since, zoom or 0.0))):
            return None
        return Stood(Position(pan, tilt, zoom), max(0.0, self._wall() - since))


def replaced(path: Path, text: str) -> None:
    """Write a file whole, or not at all, whenever the process is killed.

    Raises
    ------
    OSError
        If that failed; nothing is left of it then.
    """
    beside = path.with_name(f"{path.name}.{os.getpid()}")
    try:
        beside.write_text(text, encoding="utf-8")
        os.replace(beside, path)
    except OSError:
        with suppress(OSError):
            beside.unlink(missing_ok=True)
        raise
