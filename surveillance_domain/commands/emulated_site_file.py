"""A site file that leads to emulated cameras as if they were real ones."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError, checked_output

if TYPE_CHECKING:
    from surveillance_domain.site.site import Site

__all__ = ["PASSWORD_ENV", "check_new_file", "write_site_file"]

PASSWORD_ENV = "CAM_PASSWORD"
"""The environment variable that the file names for the cameras' password."""


def check_new_file(path: Path) -> None:
    """Before anything is started: whether the file can be written.

    Raises
    ------
    InputError
        If there is something already, or no folder for it.
    """
    if path.exists():
        raise InputError(f"--site-out {path} is there already: give another name, or remove it")
    checked_output("--site-out", path)


def write_site_file(site: Site, urls: Mapping[str, str], username: str, path: Path) -> None:
    """Write a site's file with addresses and user put in; comments and layout stay.

    Parameters
    ----------
    site : Site
    urls : mapping of str to str
        By camera.
    username : str
    path : Path

    Raises
    ------
    InputError
        If it cannot be written; see `check_new_file`.
    SiteError
        If the site would not be sound there, because of files that it names relative to its own place.
    """
    from surveillance_domain.site.editing import edited_site, set_camera_key

    built_in = resources.files("surveillance_domain.site") / "builtin" / f"{site.name}.toml"
    beside = path.with_name(f".{path.stem}.unfinished.toml")
    try:
        beside.write_bytes(built_in.read_bytes() if site.path is None else site.path.read_bytes())
        with edited_site(beside) as document:
            for camera, url in urls.items():
                for key, value in (("url", url), ("username", username), ("password_env", PASSWORD_ENV)):
                    set_camera_key(document, camera, key, value)
        beside.replace(path)
    except OSError as problem:
        raise InputError(f"{path}: {(problem.strerror or str(problem)).lower()}") from None
    finally:
        beside.unlink(missing_ok=True)
