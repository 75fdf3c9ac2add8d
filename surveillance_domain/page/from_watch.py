"""From a watch that has just done a step to what the page shows of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float32

from surveillance_domain.cameras.base import Position
from surveillance_domain.control.base import Controller
from surveillance_domain.control.loop import Step
from surveillance_domain.control.pomdp import PomdpController
from surveillance_domain.control.watch import Watch
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.looks import looks
from surveillance_domain.model.optics import orientation
from surveillance_domain.page.snapshot import CameraSnapshot, Mark, PictureSnapshot, Snapshot
from surveillance_domain.site.camera import Camera
from surveillance_domain.world.base import Sighting
from surveillance_domain.world.truth import Truth

if TYPE_CHECKING:
    from surveillance_domain.vision.base import Detection
    from surveillance_domain.world.picture_eyes import Sight

__all__ = ["snapshot_of"]

_ROUNDING = 1e-9


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
    listened, open_floor = step.sighting.looking, not surveillance.site.privacy
    shown = {name: sight for name, sight in (sights or {}).items() if open_floor or name in listened}
    pictures = _pictures(surveillance, shown, step.number)
    targets, belief = _belief(surveillance, watch.controller)
    found = {**step.sighting.observations, **step.sighting.unknown}
    return Snapshot(
        number=step.number,
        time_s=step.sighting.time_s,
        cameras=tuple(
            _camera(camera, watch, step.sighting, told[camera.name], pictures.get(camera.name))
            for camera in surveillance.site.cameras
        ),
        targets=targets,
        belief=belief,
        seen_at={target: cell for target, cell in found.items() if cell is not None},
        beyond=dict(step.sighting.beyond),
        seen=step.observed,
        present=step.present,
        truth_m=None if truth is None else _true(surveillance, truth()),
        percent_obs=summary["percent_obs"],
        expected=step.choice.value,
        restarts=summary["restarts"],
        decision_ms=step.decision_ms,
    )


def _camera(
    camera: Camera, watch: Watch, sighting: Sighting, told: Mapping[str, Any], picture: PictureSnapshot | None
) -> CameraSnapshot:
    view, report = sighting.views[camera.name], watch.world.reports[camera.name]
    at, last = watch.last_faults.get(camera.name, (0, ""))
    return CameraSnapshot(
        name=camera.name,
        view=None if view is None else [preset.name for preset in camera.presets].index(view),
        heading=None if report.position is None else _heading(camera, report.position),
        state=told["state"],
        failures=told["failures"],
        because=report.because or (f"step {at}: {last}" if last else ""),
        picture=picture,
        place=sighting.elsewhere.get(camera.name),
        private=camera.name in sighting.private,
    )


def _heading(camera: Camera, at: Position) -> tuple[float, float] | None:
    x, y = orientation(camera.mount, at.pan, at.tilt)[:2, 0].tolist()
    length = math.hypot(x, y)
    return (x / length, y / length) if length > _ROUNDING else None


def _pictures(surveillance: Surveillance, sights: Mapping[str, Sight], step: int) -> dict[str, PictureSnapshot]:
    names = {one.marker: one.name for one in looks(surveillance.site, len(surveillance.targets))} if sights else {}
    return {
        camera: PictureSnapshot(
            sight.picture.jpeg,
            (sight.picture.width, sight.picture.height),
            step,
            tuple(_mark(one.detection, names) for one in sight.located),
        )
        for camera, sight in sights.items()
    }


def _mark(detection: Detection, names: Mapping[int | None, str]) -> Mark:
    """Who it is: the target that carries the marker, else what the detector calls it."""
    identity = detection.identity
    if isinstance(identity, int):
        identity = names.get(identity, f"marker {identity}")
    return Mark(detection.pixel, detection.size_px, identity or "")


def _belief(
    surveillance: Surveillance, controller: Controller
) -> tuple[tuple[str, ...], Float32[np.ndarray, "targets cells"] | None]:
    """Whom the controller knows of, and where it thinks that they are."""
    if not isinstance(controller, PomdpController):
        return surveillance.targets, None
    cells = surveillance.site.grid.size
    places = np.zeros((len(controller.targets), cells), dtype=np.float32)
    for number, target in enumerate(controller.targets):
        places[number] = controller.belief.marginal(f"{target}.location")[:cells]  # the rest of it is off the map
    return controller.targets, places


def _true(surveillance: Surveillance, truth: Truth) -> dict[str, tuple[float, float]]:
    """Where everybody on the map is; those that the model does not know are called as a sighting calls them."""
    positions, known = truth.positions_m.tolist(), len(surveillance.targets)
    names = [
        one.name if number < known or one.marker is None else f"marker {one.marker}"
        for number, one in enumerate(looks(surveillance.site, len(positions)))
    ]
    return {name: (x, y) for name, (x, y) in zip(names, positions, strict=True) if not math.isnan(x)}
