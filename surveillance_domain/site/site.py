"""A site that was read and found to be sound."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float
from pydantic import ValidationError

from surveillance_domain.site.camera import Camera
from surveillance_domain.site.faults import Fault, SiteError
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.sections import Control, Markers, Operation, PrivateArea, StaticCamera, Targets

__all__ = ["Site"]


@dataclass(frozen=True)
class Site:
    """A place under surveillance.

    Attributes
    ----------
    name : str
        Name of the built-in site, or the file's name without its ending.
    path : Path or None
        The site file; None for a built-in site.
    digest : str
        SHA-256 over the site file and, where there are such, its map's yaml and picture and its prior's file.
    grid : Grid
        The planning grid.
    targets, control, cameras, static_cameras, operation, privacy, markers
        The tables of the site file, ``[defaults]`` merged into the cameras.
    prior : (cells,) float or None
        Probability of each free cell for a target that is on the map at the start; ``None``: they are all alike.
    """

    name: str
    path: Path | None
    digest: str
    grid: Grid
    targets: Targets
    control: Control
    cameras: tuple[Camera, ...]
    static_cameras: tuple[StaticCamera, ...] = ()
    operation: Operation = field(default_factory=Operation)
    privacy: tuple[PrivateArea, ...] = ()
    markers: Markers | None = None
    prior: Float[np.ndarray, " cells"] | None = field(default=None, compare=False, repr=False)

    def with_overrides(self, detection_probability: float | None = None, cell_noise_m: float | None = None) -> Site:
        """A copy with these values on all cameras; ``None`` leaves what the site says.

        Raises
        ------
        SiteError
            If a value is out of its range; it names the option.
        """
        given = {"detection_probability": detection_probability, "cell_noise_m": cell_noise_m}
        changes = {key: value for key, value in given.items() if value is not None}
        try:
            cameras = tuple(Camera.model_validate({**camera.model_dump(), **changes}) for camera in self.cameras)
        except ValidationError as error:
            wrong = [str(fault["loc"][0]) for fault in error.errors()]
            faults = [Fault(key, str(changes[key]), str(Camera.model_fields[key].description)) for key in wrong]
            raise SiteError(f"site {self.name}", tuple(faults)) from None
        return replace(self, cameras=cameras)
