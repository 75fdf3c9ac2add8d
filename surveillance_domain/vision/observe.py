"""From the detections of all cameras to one observation a target, as the model expects it.

The model (`surveillance_domain.model.build`) says: of the cameras that detect a target, the one with the least noise
reports its cell. A picture may show more than the view that the model gives the camera, which ends where a cell's
middle leaves the picture, and at the depth of the site file. A report that no cell in that view can give is used where
no other camera gives one of its own view, and told apart: *beyond* the view.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.model.views import Views
from surveillance_domain.site.grid import Grid
from surveillance_domain.site.site import Site
from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.ground import Ground

__all__ = ["Cell", "Located", "Observed", "Observer", "cell_of", "located"]

Cell = tuple[int, int]

_SNAP_CELLS = 1.0


@dataclass(frozen=True)
class Located:
    """A detection and where on the floor it is.

    Attributes
    ----------
    detection : Detection
    point_m : (float, float)
        x and y in metres; nan where the picture does not say.
    cell : (int, int) or None
        Column and row of the free cell it is in, or next to; ``None`` if there is none.
    """

    detection: Detection
    point_m: tuple[float, float]
    cell: Cell | None


@dataclass(frozen=True)
class Observed:
    """What all cameras saw together in one step.

    Attributes
    ----------
    observations : dict
        For each target the cell (column, row) at which it was seen, or ``None``: not seen by any camera.
    unknown : dict
        Cells of markers that belong to no target, by their number.
    without_identity : int
        Detections that may be any target; they are not used.
    out_of_view : int
        Detections on no free cell, where nobody can be; they are not used.
    beyond : dict
        Of those seen, known or not, who was seen beyond the view of the camera only, and by which camera.
    """

    observations: Mapping[str, Cell | None]
    unknown: Mapping[int | str, Cell]
    without_identity: int
    out_of_view: int
    beyond: Mapping[int | str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class _Report:
    """Where a camera saw somebody, and whether the model says that it can."""

    cell: Cell
    camera: str
    in_view: bool


def located(ground: Ground, grid: Grid, detections: Sequence[Detection]) -> tuple[Located, ...]:
    """Put detections of one picture on the floor."""
    pixels = np.array([one.pixel for one in detections], dtype=float).reshape(-1, 2)
    heights = np.array([one.height_m for one in detections], dtype=float)
    points = ground.on_floor(pixels, heights).tolist()
    return tuple(
        Located(detection, (x, y), cell_of(grid, np.array([x, y])))
        for detection, (x, y) in zip(detections, points, strict=True)
    )


def cell_of(grid: Grid, point_m: Float[np.ndarray, "2"]) -> Cell | None:
    """Column and row of the free cell that holds a point in metres, or of the nearest one less than a cell away."""
    if not np.isfinite(point_m).all():
        return None
    number = int(grid.number_at(point_m))
    if number < 0:
        away = ((grid.centres_m - point_m) ** 2).sum(axis=1)
        number = int(away.argmin())
        if away[number] >= (_SNAP_CELLS * grid.cell_m) ** 2:
            return None
    column, row = grid.cells[number].tolist()
    return column, row


class Observer:
    """Makes observations for the model of a site.

    Parameters
    ----------
    site : Site
    views : Views
        Of the site.
    targets : sequence of str
        In the model's order.
    identities : mapping of int or str to str
        The target that a marker's number, or a name that a detector gives, belongs to.
    """

    def __init__(self, site: Site, views: Views, targets: Sequence[str], identities: Mapping[int | str, str]) -> None:
        self._grid, self._views = site.grid, views
        self._targets = tuple(targets)
        self._identities = {identity: name for identity, name in identities.items() if name in self._targets}
        self._cameras = {camera.name: number for number, camera in enumerate(site.cameras)}
        self._presets = [{one.name: c for c, one in enumerate(camera.presets)} for camera in site.cameras]
        self._reports: dict[tuple[int, int], Bool[np.ndarray, " cells"]] = {}

    def observe(
        self,
        found: Mapping[str, Sequence[Located]],
        views: Mapping[str, str | None],
        elsewhere: Collection[str] = frozenset(),
    ) -> Observed:
        """One step's observation.

        Parameters
        ----------
        found : mapping of str to sequence of Located
            For each camera that looked, its detections.
        views : mapping of str to str or None
            For each camera the preset whose view it has; without one it is not listened to,
        elsewhere : collection of str
            except for these cameras, which look at no preset of their own: all that they see is beyond the model's
            views.
        """
        known: dict[int | str, _Report] = {}
        strangers: dict[int | str, _Report] = {}
        without_identity = out_of_view = 0
        for name in sorted(found, key=lambda one: (self._views.noise_m[self._cameras[one]], self._cameras[one])):
            preset = views.get(name)
            if preset is None and name not in elsewhere:
                continue
            for one in sorted(found[name], key=_surest_first):
                identity = one.detection.identity
                if identity is None:
                    without_identity += 1
                elif one.cell is None:
                    out_of_view += 1
                else:
                    in_view = preset is not None and self._reportable(name, preset, one.cell)
                    report = _Report(one.cell, name, in_view)
                    reports = known if identity in self._identities else strangers
                    _keep_better(reports, self._identities.get(identity, identity), report)
        return Observed(
            {target: known[target].cell if target in known else None for target in self._targets},
            {identity: report.cell for identity, report in strangers.items()},
            without_identity,
            out_of_view,
            {who: report.camera for who, report in {**strangers, **known}.items() if not report.in_view},
        )

    def _reportable(self, camera: str, preset: str, cell: Cell) -> bool:
        """Whether a camera can report a cell, by the model: a cell in its view may give that report."""
        from surveillance_domain.model.confusion import confusion_kernel

        number = self._cameras[camera]
        key = number, self._presets[number][preset]
        if key not in self._reports:
            seen = (self._views.detection[number][key[1]] > 0).astype(float)
            self._reports[key] = confusion_kernel(self._grid, self._views.noise_m[number]).T @ seen > 0
        return bool(self._reports[key][self._grid.number[cell[1], cell[0]]])


def _keep_better(reports: dict[int | str, _Report], who: int | str, report: _Report) -> None:
    """The first report stands, but one of the camera's own view goes before one beyond it."""
    if who not in reports or (report.in_view and not reports[who].in_view):
        reports[who] = report


def _surest_first(one: Located) -> tuple[float, float]:
    return -one.detection.confidence, -one.detection.size_px
