"""What the commands of one machine tell each other: who commands which cameras, whom people hold, and who was moved.

All of it in a folder of the user's, ``$XDG_STATE_HOME/factored-pomdp``; other users have one of their own. Under
``<site>-<digest of its path>``, ``lock`` is locked by whoever commands the cameras of that site file, for as long as
that process lives. Under ``cameras`` are files about each camera, by its address and channel, so that all site files
that name it mean the same: ``.lock`` is locked by whoever commands it, ``.heeded`` by every run that asks for
``.held``, which is there while people hold it, and ``.moved`` is there while it is left alone because somebody moved
it. Those of cameras without an address are in the site's folder.

A disk that is full, or may only be read, keeps nobody from commanding cameras: a file that is there already is locked
whatever the disk is like, and one that cannot be made is told of. ``.held`` counts without a word in it.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from surveillance_domain.control.addresses import addresses
from surveillance_domain.control.disk import disk_fails, said
from surveillance_domain.control.file_lock import Before, is_locked, locked, shared
from surveillance_domain.control.kept_memory import KeptMemory, replaced
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
        The site's, instead of that in the user's own; the cameras' is beside it then, too.

    Attributes
    ----------
    folder : Path
        The site's.
    root : Path
        All that is kept is in there.
    killed : frozenset of str
        Cameras that were commanded last by somebody who was killed; known once they are locked.

    Raises
    ------
    OSError
        If the folder cannot be made, though the disk has room and may be written to.
    """

    def __init__(self, site: Site, folder: Path | None = None) -> None:
        self._site = site
        self._held = self.killed = frozenset[str]()
        home = Path(os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state")
        where = str(site.path.resolve()) if site.path is not None else f"built-in {site.name}"
        self.folder = folder or home / "factored-pomdp" / f"{site.name}-{_digest(where, 12)}"
        self.root = self.folder.parent
        cameras = self.root / "cameras"
        self._folders = self.folder, cameras
        self._unmade = self._make_folders()
        places = addresses(site.cameras)
        self._commanded = tuple(places)
        self._files = {
            name: tuple(cameras / place for place in places[name]) if name in places else (self.folder / digest,)
            for name, digest in ((camera.name, _digest(camera.name, 16)) for camera in site.cameras)
        }

    @contextmanager
    def locked(self) -> Iterator[list[str]]:
        """Be the one who commands the cameras; what could not be locked, and why.

        Raises
        ------
        AlreadyRun
            If somebody else commands this site, or one of its cameras by another site file: which one, and their
            process number.
        PermissionError
            If a file may not even be read.
        """
        me, faults = f"process {os.getpid()}", [self._unmade] if self._unmade else []
        with ExitStack() as stack:
            before = _entered(stack, self.folder / "lock", me, faults)
            if before.holder:
                raise AlreadyRun(
                    f"site {self._site.name} is being run already, by {before.holder}; stop that one first"
                )
            where = str(self._site.path) if self._site.path is not None else self._site.name
            for path, name in self._by_file(".lock", self._commanded).items():
                before = _entered(stack, path, f"site {where} as camera {name!r}, {me}", faults)
                self.killed |= {name} if before.killed else set()
                if before.holder:
                    camera = next(one for one in self._site.cameras if one.name == name)
                    raise AlreadyRun(
                        f"camera {name!r} ({camera.url}, channel {camera.channel}) is commanded already, by "
                        f"{before.holder}; stop that one first"
                    )
            yield faults

    @contextmanager
    def heeding(self) -> Iterator[None]:
        """While it goes on, `heeded` says so of the site's cameras: for whoever asks for `held` again and again.

        Where that cannot be said they are heeded all the same.
        """
        with ExitStack() as stack:
            for path in self._by_file(".heeded", self._files):
                with suppress(OSError):
                    stack.enter_context(shared(path))
            yield

    def heeded(self, camera: str) -> bool:
        """Whether somebody is there, with this site file or another, who leaves the camera alone if it is held."""
        return any(is_locked(path) for path in self._by_file(".heeded", [camera]))

    def held(self) -> frozenset[str]:
        """Cameras of the site that people hold, by whatever site file; where that cannot be read, as it was before."""
        self._held = frozenset(name for name in self._files if self._is_held(name))
        return self._held

    def hold(self, camera: str, hold: bool = True) -> None:
        """Take a camera, or give it back.

        Raises
        ------
        ValueError
            For a camera that is not at the site.
        OSError
            If that cannot be kept, not even by an empty file.
        """
        if camera not in self._files:
            raise ValueError(f"site {self._site.name} has no camera {camera!r} (there are: {', '.join(self._files)})")
        mine = list(self._by_file(".held", [camera]))
        if hold:
            self._make_each()
            for path in mine:
                _kept(path, json.dumps([one.name for one in mine]))
            return
        for path in mine:
            others = _names_in(path)
            path.unlink(missing_ok=True)
            for name in others:  # a name that stood for another address when it was taken
                path.with_name(name).unlink(missing_ok=True)

    def memories(self) -> dict[str, KeptMemory]:
        """Of the cameras that have an address, by name: who was moved by somebody."""
        return {name: KeptMemory(list(self._by_file(".moved", [name]))) for name in self._commanded}

    def _make_each(self) -> None:
        for folder in self._folders:
            folder.mkdir(parents=True, exist_ok=True)

    def _make_folders(self) -> str:
        """Why they are not there, if the disk is to blame."""
        try:
            self._make_each()
        except OSError as problem:
            if not disk_fails(problem):
                raise
            return said(problem)
        return ""

    def _by_file(self, suffix: str, cameras: Iterable[str]) -> dict[Path, str]:
        """Every file that is about some cameras, and one that it is about."""
        return {path.with_suffix(suffix): name for name in cameras for path in self._files[name]}

    def _is_held(self, camera: str) -> bool:
        try:
            return any(_is_there(path) for path in self._by_file(".held", [camera]))
        except OSError:
            return camera in self._held


def _digest(text: str, characters: int) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:characters]


def _is_there(path: Path) -> bool:
    """Unlike `Path.exists`, which takes a file that cannot be asked for to be missing."""
    try:
        path.stat()
    except FileNotFoundError:
        return False
    return True


def _names_in(path: Path) -> list[str]:
    """Under which names a hold is kept, as far as that can be read."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return []
    names = content if isinstance(content, list) else []
    return [name for name in names if isinstance(name, str) and name == Path(name).name and name.endswith(".held")]


def _kept(path: Path, text: str) -> None:
    """A file with a text; without room for that an empty one."""
    try:
        replaced(path, text)
    except OSError:
        if not _is_there(path):
            path.touch()


def _entered(stack: ExitStack, path: Path, told: str, faults: list[str]) -> Before:
    """Who had locked a file before; locked by us for the length of a stack, if nobody has and that can be done."""
    try:
        return stack.enter_context(locked(path, told))
    except OSError as problem:
        if isinstance(problem, PermissionError) and _is_there(path):
            raise
        faults.append(said(problem))
        return Before("", "")
