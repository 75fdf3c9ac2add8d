"""What the commands of one machine tell each other about a site: who runs it, and which cameras people hold.

A folder of the user's for each site, ``$XDG_STATE_HOME/factored-pomdp/<site>-<digest of its path>``: ``lock`` is locked
by whoever commands the cameras, for as long as that process lives; ``held.json`` names the cameras that are held.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from surveillance_domain.site.site import Site

__all__ = ["AlreadyRun", "WatchState"]


class AlreadyRun(RuntimeError):
    """Another process commands the cameras of this site."""


class WatchState:
    """The state of one site.

    Parameters
    ----------
    site : Site
    folder : Path, optional
        Instead of that in the user's own.

    Raises
    ------
    OSError
        If the folder cannot be made.
    """

    def __init__(self, site: Site, folder: Path | None = None) -> None:
        self._site = site
        self._held = frozenset[str]()
        home = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
        where = str(site.path.resolve()) if site.path is not None else f"built-in {site.name}"
        self.folder = (
            folder or home / "factored-pomdp" / f"{site.name}-{hashlib.sha256(where.encode()).hexdigest()[:12]}"
        )
        self.folder.mkdir(parents=True, exist_ok=True)

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Be the one who commands the cameras.

        Raises
        ------
        AlreadyRun
            If somebody else is, with their process number.
        """
        with (self.folder / "lock").open("a+", encoding="ascii") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                lock.seek(0)
                raise AlreadyRun(
                    f"site {self._site.name} is being run already, by process {lock.read().strip() or 'unknown'}; "
                    "stop that one first"
                ) from None
            lock.truncate(0)
            lock.write(str(os.getpid()))
            lock.flush()
            try:
                yield
            finally:
                lock.truncate(0)

    def held(self) -> frozenset[str]:
        """Cameras that people hold; those of the site only. Where that cannot be read, those that they held before."""
        try:
            names = json.loads((self.folder / "held.json").read_text(encoding="utf-8"))
            self._held = frozenset(names) & {camera.name for camera in self._site.cameras}
        except FileNotFoundError:
            self._held = frozenset()
        except (OSError, ValueError, TypeError):
            pass
        return self._held

    def hold(self, camera: str, hold: bool = True) -> None:
        """Take a camera, or give it back.

        Raises
        ------
        ValueError
            For a camera that is not at the site.
        """
        names = [one.name for one in self._site.cameras]
        if camera not in names:
            raise ValueError(f"site {self._site.name} has no camera {camera!r} (there are: {', '.join(names)})")
        held = self.held() | {camera} if hold else self.held() - {camera}
        beside = self.folder / f"held.json.{os.getpid()}"
        beside.write_text(json.dumps(sorted(held)), encoding="utf-8")
        os.replace(beside, self.folder / "held.json")
