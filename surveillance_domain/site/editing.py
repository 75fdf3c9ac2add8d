"""Changing a site file and leaving the rest of it as it was: comments, order and layout stay.

The new file is written beside the old one, read as a site, and put in its place only if it is sound.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from copy import deepcopy
from pathlib import Path
from typing import TYPE_CHECKING, Any

from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.load import load_site
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from tomlkit import TOMLDocument

__all__ = ["add_preset", "editable_path", "edited_site", "set_camera_key", "set_homography"]


def editable_path(site: Site) -> Path:
    """The file of a site.

    Raises
    ------
    SiteError
        For a built-in site, which has none of the user's own.
    """
    if site.path is None:
        fault = Fault("", "a built-in site, which is not changed", "the path of a site file of your own")
        raise SiteError(f"built-in site {site.name}", (fault,))
    return site.path


@contextmanager
def edited_site(path: Path, check: Callable[[Site], object] | None = None) -> Iterator[TOMLDocument]:
    """A site file as a document to be changed; it is written when the block ends without an error.

    A symbolic link stays one: the file that it points to is changed.

    Parameters
    ----------
    path : Path
    check : callable, optional
        Asked of the changed site, beyond what reading it checks; raises `SiteError` if the site is not sound.

    Raises
    ------
    SiteError
        If the file with its changes is not sound; it is then left as it was.
    OSError
        If it cannot be read or written.
    """
    import tomlkit

    target = path.resolve()
    document = tomlkit.parse(target.read_bytes().decode("utf-8"))
    yield document
    handle, name = tempfile.mkstemp(prefix=f".{target.stem}-", suffix=".toml", dir=target.parent)
    beside = Path(name)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(tomlkit.dumps(document).encode("utf-8"))
        try:
            changed = load_site(beside)
            if check is not None:
                check(changed)
        except SiteError as problem:
            raise SiteError(f"{path}, as it would be changed", problem.faults) from None
        beside.chmod(target.stat().st_mode & 0o7777)
        beside.replace(target)
    finally:
        beside.unlink(missing_ok=True)


def set_camera_key(document: TOMLDocument, camera: str, key: str, value: Any) -> None:
    """Give a camera a value of its own; what other cameras have, from ``[defaults]`` too, stays.

    A table is changed in the keys that ``value`` has.
    """
    table, defaults = _camera(document, camera), document.get("defaults", {})
    if isinstance(value, dict):
        if key not in table:
            table[key] = deepcopy(defaults[key])
        table[key].update(value)
    else:
        table[key] = value


def set_homography(document: TOMLDocument, camera: str, preset: str, homography: list[list[float]] | None) -> None:
    """Give a preset its homography, or take it away; presets from ``[defaults]`` become the camera's own."""
    for one in _own_presets(document, camera):
        if one["name"] == preset:
            if homography is not None:
                one["homography"] = homography
            elif "homography" in one:
                del one["homography"]


def add_preset(document: TOMLDocument, camera: str, preset: dict[str, Any]) -> None:
    """Give a camera one more preset, in the form in which the others are written."""
    import tomlkit
    from tomlkit.items import AoT

    presets = _own_presets(document, camera)
    written: Any = tomlkit.table() if isinstance(presets, AoT) else tomlkit.inline_table()
    written.update(preset)
    presets.append(written)


def _camera(document: TOMLDocument, name: str) -> Any:
    cameras: Any = document["cameras"]
    for table in cameras:
        if table["name"] == name:
            return table
    raise KeyError(name)


def _own_presets(document: TOMLDocument, camera: str) -> Any:
    table, defaults = _camera(document, camera), document.get("defaults", {})
    if "presets" not in table:
        table["presets"] = deepcopy(defaults["presets"])
    return table["presets"]
