"""What the commands of one machine tell each other about a site: who runs it, and which cameras people hold.

A folder of the user's for each site, ``$XDG_STATE_HOME/factored-pomdp/<site>-<digest of its path>``: ``lock`` is locked
by whoever commands the cameras, for as long as that process lives; ``heeded`` by every run that asks for ``held.json``,
the names of the cameras that are held. Beside it, ``cameras`` has a lock for every camera, by its address and channel,
so that two site files do not command the same one. Other users have folders, and locks, of their own.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import IO
from urllib.parse import urlsplit

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.site import Site

__all__ = ["AlreadyRun", "WatchState"]


class AlreadyRun(RuntimeError):
    """Another process commands the cameras of this site, or one of them."""


class WatchState:
    """The state of one site.

    Parameters
    ----------
    site : Site
    folder : Path, optional
        Instead of that in the user's own; the cameras' locks are beside it then, too.

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
        self._cameras = self.folder.parent / "cameras"
        self.folder.mkdir(parents=True, exist_ok=True)
        self._cameras.mkdir(exist_ok=True)

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Be the one who commands the cameras.

        Raises
        ------
        AlreadyRun
            If somebody else commands this site, or one of its cameras by another site file: which one, and their
            process number.
        """
        me = str(os.getpid())
        with ExitStack() as stack:
            holder = stack.enter_context(_locked(self.folder / "lock", me))
            if holder is not None:
                raise AlreadyRun(
                    f"site {self._site.name} is being run already, by process {holder}; stop that one first"
                )
            for place, camera in self._places().items():
                where = str(self._site.path) if self._site.path is not None else self._site.name
                told = f"site {where} as camera {camera.name!r}, process {me}"
                holder = stack.enter_context(_locked(self._cameras / f"{place}.lock", told))
                if holder is not None:
                    raise AlreadyRun(
                        f"camera {camera.name!r} ({camera.url}, channel {camera.channel}) is commanded already, by "
                        f"{holder}; stop that one first"
                    )
            yield

    @contextmanager
    def heeding(self) -> Iterator[None]:
        """While it goes on, `heeded` says so: for whoever asks for `held` again and again."""
        with (self.folder / "heeded").open("a") as mark:
            fcntl.flock(mark, fcntl.LOCK_SH)
            yield

    def heeded(self) -> bool:
        """Whether somebody is there who leaves cameras alone that are held."""
        with (self.folder / "heeded").open("a") as mark:
            return not _lock(mark)

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

    def _places(self) -> dict[str, Camera]:
        """The site's cameras that have an address, by what tells them apart."""
        return {_place(camera.url, camera.channel): camera for camera in self._site.cameras if camera.url is not None}


def _place(url: str, channel: int) -> str:
    """The same for all ways to write a camera's address; but not for a name and a number that stand for one another."""
    parts = urlsplit(url)
    port = "" if parts.port in (None, 80, 443) else f":{parts.port}"
    where = f"{(parts.hostname or '').lower()}{port} channel {channel}"
    return hashlib.sha256(where.encode()).hexdigest()[:16]


@contextmanager
def _locked(path: Path, told: str) -> Iterator[str | None]:
    """Lock a file and write into it who did; or what stands in it, if it is locked already."""
    with path.open("a+", encoding="utf-8") as lock:
        if not _lock(lock):
            lock.seek(0)
            yield lock.read().strip() or "unknown"
            return
        lock.truncate(0)
        lock.write(told)
        lock.flush()
        try:
            yield None
        finally:
            lock.truncate(0)


def _lock(file: IO[str]) -> bool:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
