"""What the page knows of one step: a small record that nothing changes any more, so that threads may share it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float32, Float64

from surveillance_domain.control.base import Controller
from surveillance_domain.control.loop import Step
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.watch import Watch
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.looks import looks
from surveillance_domain.model.optics import orientation
from surveillance_domain.site.camera import Camera
from surveillance_domain.world.base import Cell
from surveillance_domain.world.network import CameraReport
from surveillance_domain.world.truth import Truth

if TYPE_CHECKING:
    from surveillance_domain.vision.base import Detection
    from surveillance_domain.world.picture_eyes import Sight

__all__ = ["CameraSnapshot", "Mark", "PictureSnapshot", "Snapshot", "snapshot_of"]

_ROUNDING = 1e-9


@dataclass(frozen=True)
class Mark:
    """A detection in a picture.

    Attributes
    ----------
    pixel : (float, float)
        To the right, and down.
    size_px : float
    label : str
        Who it is; empty where the picture does not tell.
    """

    pixel: tuple[float, float]
    size_px: float
    label: str


@dataclass(frozen=True)
class PictureSnapshot:
    """A camera's picture and what was found in it.

    Attributes
    ----------
    jpeg : bytes
    size : (int, int)
        Width and height in pixels.
    step : int
        When it was taken.
    marks : tuple of Mark
    """

    jpeg: bytes
    size: tuple[int, int]
    step: int
    marks: tuple[Mark, ...]


@dataclass(frozen=True)
class CameraSnapshot:
    """How a camera is.

    Attributes
    ----------
    name : str
    view : int or None
        Number of the preset that it really looked at; ``None``: it had no view.
    heading : (float, float) or None
        Unit vector on the floor of where it looked, as read back; ``None``: not known, or straight down.
    state : str
        Such as ``ready``, ``away``, ``held``.
    failures : int
        Steps without a view so far, though nobody else had it.
    because : str
        What went wrong with it; empty if nothing did.
    picture : PictureSnapshot or None
        Of this step.
    """

    name: str
    view: int | None
    heading: tuple[float, float] | None
    state: str
    failures: int
    because: str
    picture: PictureSnapshot | None


@dataclass(frozen=True, eq=False)
class Snapshot:
    """One step, as the page shows it.

    Attributes
    ----------
    number : int
        Of the step, from 1.
    time_s : float
        On the world's clock, since the start.
    cameras : tuple of CameraSnapshot
        In the site's order.
    belief : (targets, cells) float or None
        Probability of each free cell, after the sighting; ``None`` for controllers without a belief.
    seen_at : tuple of Cell or None
        For each target where it was seen.
    positions_m : (targets, 2) float or None
        Where the targets really are, where there is a truth.
    percent_obs : float or None
        So far, in percent; ``None`` where there is no truth.
    expected : float or None
        Targets that the choice of this step expected to be seen.
    restarts : int
        Beliefs started anew so far.
    decision_ms : float
    """

    number: int
    time_s: float
    cameras: tuple[CameraSnapshot, ...]
    belief: Float32[np.ndarray, "targets cells"] | None
    seen_at: tuple[Cell | None, ...]
    positions_m: Float64[np.ndarray, "targets 2"] | None
    percent_obs: float | None
    expected: float | None
    restarts: int
    decision_ms: float

    @property
    def seen(self) -> int:
        """How many targets were seen."""
        return sum(cell is not None for cell in self.seen_at)


def snapshot_of(
    step: Step,
    watch: Watch,
    surveillance: Surveillance,
    truth: Callable[[], Truth] | None = None,
    sights: Mapping[str, Sight] | None = None,
) -> Snapshot:
    """A step that a watch has just done, copied; to be called by the thread of the watch, before the next step.

    Parameters
    ----------
    truth : callable, optional
        The targets' true state, where there is one.
    sights : mapping, optional
        By camera, the pictures of this step, where pictures are looked at.
    """
    summary = watch.summary()
    told = {camera["name"]: camera for camera in summary["cameras"]}
    reports = watch.world.reports
    names: dict[int | str | None, str] = {
        one.marker: one.name for one in looks(surveillance.site, len(surveillance.targets))
    }
    return Snapshot(
        number=step.number,
        time_s=step.sighting.time_s,
        cameras=tuple(
            _camera(camera, step, reports[camera.name], told[camera.name], (sights or {}).get(camera.name), names)
            for camera in surveillance.site.cameras
        ),
        belief=_belief(surveillance, watch.controller),
        seen_at=tuple(step.sighting.observations[target] for target in surveillance.targets),
        positions_m=None if truth is None else np.array(truth().positions_m, dtype=float),
        percent_obs=summary["percent_obs"],
        expected=step.choice.value,
        restarts=summary["restarts"],
        decision_ms=step.decision_ms,
    )


def _camera(
    camera: Camera,
    step: Step,
    report: CameraReport,
    told: Mapping[str, Any],
    sight: Sight | None,
    names: Mapping[int | str | None, str],
) -> CameraSnapshot:
    view = step.sighting.views[camera.name]
    return CameraSnapshot(
        name=camera.name,
        view=None if view is None else [preset.name for preset in camera.presets].index(view),
        heading=_heading(camera, report),
        state=told["state"],
        failures=told["failures"],
        because=report.because,
        picture=None if sight is None else _picture(sight, step.number, names),
    )


def _heading(camera: Camera, report: CameraReport) -> tuple[float, float] | None:
    if report.position is None:
        return None
    x, y = orientation(camera.mount, report.position.pan, report.position.tilt)[:2, 0].tolist()
    length = math.hypot(x, y)
    return (x / length, y / length) if length > _ROUNDING else None


def _picture(sight: Sight, step: int, names: Mapping[int | str | None, str]) -> PictureSnapshot:
    marks = tuple(_mark(one.detection, names) for one in sight.located)
    return PictureSnapshot(sight.picture.jpeg, (sight.picture.width, sight.picture.height), step, marks)


def _mark(detection: Detection, names: Mapping[int | str | None, str]) -> Mark:
    """Who it is: the target that has the marker, else what the detector calls it."""
    identity = detection.identity
    known = "" if identity is None else names.get(identity, str(identity))
    return Mark(detection.pixel, detection.size_px, known)


def _belief(surveillance: Surveillance, controller: Controller) -> Float32[np.ndarray, "targets cells"] | None:
    if not isinstance(controller, PomdpController):
        return None
    places = [controller.belief.marginal(f"{target}.location") for target in surveillance.targets]
    return np.asarray(places, dtype=np.float32)
