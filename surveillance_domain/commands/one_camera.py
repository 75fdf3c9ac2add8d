"""Commands that speak with one camera of a site."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from surveillance_domain.cameras.base import Camera
    from surveillance_domain.site.camera import Camera as CameraDescription
    from surveillance_domain.site.site import Site

__all__ = ["described_camera", "opened_camera"]

_START_S = 10.0


def described_camera(site: Site, name: str) -> CameraDescription:
    """A camera of a site by its name.

    Raises
    ------
    InputError
        With what was probably meant.
    """
    from factored_pomdp.errors import did_you_mean

    cameras = {camera.name: camera for camera in site.cameras}
    if name not in cameras:
        raise InputError(f"site {site.name}: no camera {name!r}{did_you_mean(name, cameras)}")
    return cameras[name]


@contextmanager
def opened_camera(site: Site, description: CameraDescription) -> Iterator[Camera]:
    """A camera that answers, let go of at the end.

    Raises
    ------
    InputError
        Saying why it cannot be spoken with, then or at any time in the block.
    """
    import numpy as np

    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.cameras.errors import CameraError
    from surveillance_domain.cameras.opening import open_camera

    folder = None if site.path is None else site.path.parent
    try:
        camera = open_camera(description, RealClock(), np.random.default_rng(), folder)
        try:
            camera.start(_START_S)
            yield camera
        finally:
            camera.close()
    except CameraError as problem:
        raise InputError(str(problem)) from None
