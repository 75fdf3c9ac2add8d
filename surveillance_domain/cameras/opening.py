"""From what a site says of a camera to its driver."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.errors import CameraError
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.site.camera import Camera as CameraDescription

if TYPE_CHECKING:
    import requests

__all__ = ["open_camera"]


def open_camera(
    description: CameraDescription,
    clock: Clock,
    rng: np.random.Generator,
    folder: Path | None = None,
    session: requests.Session | None = None,
    password: str | None = None,
) -> VapixCamera:
    """The driver of a camera; nothing is asked of it yet.

    Parameters
    ----------
    description : CameraDescription
        With a ``url``.
    clock : Clock
    rng : numpy.random.Generator
        For the jitter of retries.
    folder : Path, optional
        Where a relative ``ca_file`` starts: the site file's folder.
    session : requests.Session, optional
        Instead of a new one.
    password : str, optional
        Instead of that in the environment variable ``password_env``.

    Raises
    ------
    CameraError
        If the site gives no url, or the environment variable is not set, or is empty.
    """
    import requests

    from surveillance_domain.cameras.authentication import CameraLogin
    from surveillance_domain.cameras.exchange import Exchange

    if description.url is None:
        raise CameraError(f"{description.name}: no url; give the camera's address, such as http://192.168.0.90")
    if password is None and description.password_env is not None:
        password = os.environ.get(description.password_env)
        if not password:  # an empty one would be a failed log-in, of which cameras forgive but a few
            empty = "" if password is None else ", which is empty"
            raise CameraError(
                f"{description.name}: set {description.password_env}, the variable of its password{empty}"
            )
    login = None
    if description.username is not None:
        secure = description.url.startswith("https:")
        login = CameraLogin(description.username, password or "", description.auth, secure)
    session = session or requests.Session()
    session.trust_env = False  # cameras are near: no proxy stands between, and no .netrc knows their passwords
    session.headers["Accept-Encoding"] = "identity"
    if description.ca_file is not None:
        session.verify = str((folder or Path()) / description.ca_file)
    timeouts_s = (description.connect_timeout_s, description.read_timeout_s)
    exchange = Exchange(description.name, description.url, session, login, clock, *timeouts_s)
    return VapixCamera(description, exchange, clock, rng)
