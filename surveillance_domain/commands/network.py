"""From a site and what the user asked for to a network of cameras, real or emulated, that is ready to be run."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

from factored_pomdp.commands.answers import InputError

if TYPE_CHECKING:
    import numpy as np

    from surveillance_domain.cameras.base import Camera
    from surveillance_domain.cameras.clock import Clock
    from surveillance_domain.cameras.vapix import VapixCamera
    from surveillance_domain.model.build import Surveillance
    from surveillance_domain.site.site import Site
    from surveillance_domain.world.eyes import Eyes
    from surveillance_domain.world.memory import Memory
    from surveillance_domain.world.network import NetworkWorld
    from surveillance_domain.world.truth import Truth

__all__ = ["Network", "network_of", "opened"]


@dataclass(frozen=True, eq=False)
class Network:
    """Cameras that can be spoken with.

    Attributes
    ----------
    surveillance : Surveillance
    cameras : tuple of Camera
    world : NetworkWorld
    eyes : Eyes
    truth : callable or None
        The targets' true state, where the cameras are emulated.
    clock : Clock
    """

    surveillance: Surveillance
    cameras: tuple[Camera, ...]
    world: NetworkWorld
    eyes: Eyes
    truth: Callable[[], Truth] | None
    clock: Clock


@contextmanager
def network_of(
    site: Site,
    targets: int,
    *,
    emulated: bool,
    seed: int,
    virtual: bool = False,
    pictures: bool = True,
    strangers: int = 0,
    held: Callable[[], Collection[str]] = frozenset,
    moves: bool = True,
    memories: Mapping[str, Memory] | None = None,
) -> Iterator[Network]:
    """Open all cameras of a site; closed again at the end.

    Parameters
    ----------
    emulated : bool
        Start emulated cameras on loopback, and speak with those.
    virtual : bool
        In virtual time; emulated cameras only.
    pictures : bool
        Find targets in pictures. Otherwise, with emulated cameras only, detections are drawn from the model.
    strangers : int
        Emulated cameras only: how many targets move there beside those of the model.
    held, moves, memories
        See `NetworkWorld`.

    Raises
    ------
    InputError, SiteError
        Saying what is missing or wrong.
    VisionMissing
        If pictures are to be looked at, and OpenCV is not installed.
    """
    import numpy as np

    from surveillance_domain.cameras.clock import RealClock
    from surveillance_domain.model.build import surveillance_model
    from surveillance_domain.vision.opencv import opencv
    from surveillance_domain.world.network import NetworkWorld

    for_truth, for_retries, for_eyes = np.random.default_rng(seed).spawn(3)
    clock: Clock = RealClock()
    with ExitStack() as stack:
        truth = None
        if emulated:
            from surveillance_domain.emulation.site import EmulatedSite
            from surveillance_domain.emulation.truth_eyes import TruthEyes
            from surveillance_domain.emulation.virtual_clock import VirtualClock

            clock = VirtualClock() if virtual else clock
            opencv()
            emulation = stack.enter_context(EmulatedSite(site, targets + strangers, clock, for_truth))
            surveillance = surveillance_model(emulation.site, targets)
            cameras: tuple[Camera, ...] = emulation.open_cameras(for_retries)
            truth = lambda: emulation.truth  # noqa: E731
        else:
            surveillance = surveillance_model(site, targets)
            cameras = opened(site, clock, for_retries)
        eyes: Eyes
        if pictures:
            from surveillance_domain.world.picture_eyes import PictureEyes

            eyes = PictureEyes(surveillance)
        else:
            eyes = TruthEyes(surveillance, emulation, for_eyes)
        world = NetworkWorld(surveillance.site, cameras, eyes, clock, held, moves, memories)
        stack.callback(world.close)
        yield Network(surveillance, cameras, world, eyes, truth, clock)


def opened(site: Site, clock: Clock, luck: np.random.Generator) -> tuple[VapixCamera, ...]:
    """The drivers of a site's cameras.

    Parameters
    ----------
    luck : numpy.random.Generator
        For the jitter of retries.

    Raises
    ------
    InputError
        Naming every camera that lacks its address, or the environment variable with its password.
    """
    from surveillance_domain.cameras.errors import CameraError
    from surveillance_domain.cameras.opening import open_camera

    folder = site.path.parent if site.path is not None else None
    cameras: list[VapixCamera] = []
    faults: list[str] = []
    for description, rng in zip(site.cameras, luck.spawn(len(site.cameras)), strict=True):
        try:
            cameras.append(open_camera(description, clock, rng, folder))
        except CameraError as problem:
            faults.append(str(problem))
    if faults:
        for camera in cameras:
            camera.close()
        raise InputError(f"site {site.name}: {'; '.join(faults)}")
    return tuple(cameras)
