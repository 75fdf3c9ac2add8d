"""A whole emulated site: targets that move, and a server for every camera."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from types import TracebackType
from typing import Literal

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.base import Limits
from surveillance_domain.cameras.clock import Clock
from surveillance_domain.cameras.opening import open_camera
from surveillance_domain.cameras.vapix import VapixCamera
from surveillance_domain.emulation.camera import EmulatedCamera
from surveillance_domain.emulation.guard import Guard
from surveillance_domain.emulation.mask_painting import MaskPainter
from surveillance_domain.emulation.motors import EmulatedMotors
from surveillance_domain.emulation.moving_targets import MovingTargets
from surveillance_domain.emulation.rendering import Renderer
from surveillance_domain.emulation.server import CameraServer
from surveillance_domain.emulation.virtual_clock import VirtualClock
from surveillance_domain.emulation.virtual_session import virtual_session
from surveillance_domain.model.build import motion_parameters, starting_places
from surveillance_domain.model.looks import Look, looks
from surveillance_domain.model.motion import motion_tables
from surveillance_domain.model.pinhole import pinhole
from surveillance_domain.site.camera import Camera as CameraDescription
from surveillance_domain.site.site import Site
from surveillance_domain.vision.points import FloorMarker
from surveillance_domain.world.truth import Truth
from surveillance_domain.world.truth_continuous import ContinuousTruth
from surveillance_domain.world.truth_grid import GridTruth

__all__ = ["EmulatedSite", "PASSWORD", "USERNAME"]

USERNAME = "operator"
PASSWORD = "emulated"
"""Of all emulated cameras; nothing is behind it."""

_AXIS_214_PAN, _AXIS_214_ZOOM = (-170.0, 170.0), (1.0, 9999.0)
_AXIS_214_TILT_STANDING, _AXIS_214_TILT_HANGING = (-90.0, 30.0), (-30.0, 90.0)


class EmulatedSite:
    """Runs from the moment it is made until it is closed; also a context manager.

    Parameters
    ----------
    site : Site
    targets : int
    clock : Clock
        A `VirtualClock`, or the wall's.
    rng : numpy.random.Generator
        For truth, pictures, nonces and faults; made from a seed.
    truth : {"grid", "continuous"}
        Targets move by the model's own chain, or in metres; where the site has doors, they come and go.
    smooth : bool, optional
        Between steps targets go straight on instead of jumping; by default if the truth is continuous.
    first_port : int
        0: free ones; otherwise the cameras are served on ports from this one up.
    laid : sequence of FloorMarker
        Markers that lie there, where the site has markers.

    Attributes
    ----------
    site : Site
        The same, its cameras with the addresses and the user of the emulated ones.
    cameras : dict of str to EmulatedCamera
        Faults are set here: ``emulated.cameras["north"].faults.latency_s = 3``.
    servers : dict of str to CameraServer
    looks : tuple of Look
        Of the targets.
    """

    def __init__(
        self,
        site: Site,
        targets: int,
        clock: Clock,
        rng: np.random.Generator,
        truth: Literal["grid", "continuous"] = "continuous",
        smooth: bool | None = None,
        first_port: int = 0,
        laid: Sequence[FloorMarker] = (),
    ) -> None:
        for_truth, for_pictures, self._for_cameras = rng.spawn(3)
        kind = GridTruth if truth == "grid" else ContinuousTruth
        start = kind.initial(site.grid, motion_parameters(site), targets, for_truth, _presence(site))
        self.looks: tuple[Look, ...] = looks(site, targets)
        self._clock, self._renderer = clock, Renderer(site, self.looks, for_pictures, laid=laid)
        directions, step_s = site.targets.directions, site.control.step_s
        self._targets = MovingTargets(
            start, step_s, directions, clock, truth == "continuous" if smooth is None else smooth
        )
        self.cameras: dict[str, EmulatedCamera] = {}
        self.servers: dict[str, CameraServer] = {}
        try:
            for number, description in enumerate(site.cameras):
                self.cameras[description.name] = camera = self._camera(description, number)
                self.servers[description.name] = CameraServer(camera, first_port and first_port + number)
        except OSError:
            self.close()
            raise
        self.site = replace(site, cameras=tuple(self._reachable(one) for one in site.cameras))

    def __enter__(self) -> EmulatedSite:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self.close()

    @property
    def truth(self) -> Truth:
        """Where the targets really are, at the last step that is over."""
        return self._targets.truth

    def open_cameras(self, rng: np.random.Generator) -> tuple[VapixCamera, ...]:
        """A driver for each camera, on the emulator's clock.

        Parameters
        ----------
        rng : numpy.random.Generator
            For the jitter of retries.
        """
        virtual = isinstance(self._clock, VirtualClock)
        return tuple(
            open_camera(
                description,
                self._clock,
                luck,
                session=virtual_session() if virtual else None,
                password=PASSWORD,
            )
            for description, luck in zip(self.site.cameras, rng.spawn(len(self.site.cameras)), strict=True)
        )

    def close(self) -> None:
        """Stop all servers."""
        for server in self.servers.values():
            server.close()

    def _reachable(self, description: CameraDescription) -> CameraDescription:
        changes = {"url": self.servers[description.name].url, "username": USERNAME, "password_env": None}
        return description.model_copy(update={**changes, "auth": "auto", "ca_file": None})

    def _camera(self, description: CameraDescription, number: int) -> EmulatedCamera:
        for_nonces, for_faults, for_noise = self._for_cameras.spawn(3)
        first = description.presets[0]
        speeds = (description.pan_deg_per_s, description.tilt_deg_per_s, description.zoom_per_s)
        pan, tilt, zoom = (math.inf if speed is None else speed for speed in speeds)
        motors = EmulatedMotors(
            (first.pan, first.tilt, first.zoom), emulated_limits(description), (pan, tilt, zoom), self._clock
        )
        guard = Guard(f"AXIS_ACCC8E{number + 1:06X}", USERNAME, PASSWORD, self._clock, for_nonces)

        masks = MaskPainter(description)

        def snapshot(size: tuple[int, int], compression: int) -> bytes:
            view = pinhole(description, *motors.true(), size)
            return self._renderer.jpeg(view, *self._targets.poses(), compression, for_noise, masks)

        size = (description.image.width, description.image.height)
        magnification = tuple((zoom, _half(description, 0) / _half(description, n)) for n, zoom in _zooms(description))
        return EmulatedCamera(
            motors, guard, snapshot, size, magnification, self._clock, for_faults, description.channel
        )


def emulated_limits(description: CameraDescription) -> Limits:
    """Those of an AXIS 214 PTZ, widened as far as the camera's presets need it."""
    tilt = _AXIS_214_TILT_HANGING if description.mount.inverted else _AXIS_214_TILT_STANDING
    ends = []
    for axis, (low, high) in (("pan", _AXIS_214_PAN), ("tilt", tilt), ("zoom", _AXIS_214_ZOOM)):
        used = [getattr(preset, axis) for preset in description.presets]
        ends.append((min(low, *used), max(high, *used)))
    return Limits(*ends)


def _presence(site: Site) -> Float[np.ndarray, " places"] | None:
    """How likely a target is in each free cell, and outside, when it all begins; ``None``: anywhere, all alike."""
    outside = motion_tables(site.grid, motion_parameters(site)).outside_share if site.targets.doors else None
    return None if outside is None and site.prior is None else starting_places(site, outside)


def _zooms(description: CameraDescription) -> list[tuple[int, float]]:
    return [(number, zoom) for number, (zoom, _) in enumerate(description.zoom_hfov)]


def _half(description: CameraDescription, number: int) -> float:
    """Half the width of the picture at unit distance, at one of the zooms that the site lists."""
    return math.tan(math.radians(description.zoom_hfov[number][1]) / 2)
