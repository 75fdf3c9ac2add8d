"""Commands that speak with one camera of a site."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    from surveillance_domain.cameras.base import Camera, Position
    from surveillance_domain.site.camera import Camera as CameraDescription
    from surveillance_domain.site.site import Site

__all__ = ["described_camera", "opened_camera", "standing_position"]

_START_S = 10.0
_READ_S = 10.0
_POLL_S = 0.1
_LEAST_STILL_S = 1.0


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


def standing_position(driver: Camera, description: CameraDescription) -> Position:
    """Where a camera stands, once it has stood still for its settle time, and for a second at least.

    Raises
    ------
    InputError
        If it still moves after ``move_deadline_s``.
    """
    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.cameras.steadiness import Steadiness

    clock, steadiness = RealClock(), Steadiness(description.tolerance_deg / 2)
    still_s = max(description.settle_s, _LEAST_STILL_S)
    until = clock.now() + max(description.move_deadline_s, still_s + _POLL_S)
    while True:
        position = driver.position(_READ_S)
        steadiness.read(position, clock.now())
        if steadiness.still_s(clock.now()) >= still_s:
            return position
        if clock.now() >= until:
            raise InputError(
                f"camera {description.name!r} still moves, at pan {position.pan:g}, tilt {position.tilt:g}: wait until "
                "it stands, and stop a guard tour if there is one; then try again"
            )
        clock.sleep(_POLL_S)
