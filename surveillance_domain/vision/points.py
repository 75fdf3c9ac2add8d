"""Points of the floor that were found in pictures, by a click or by a marker: what calibration is made of."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from surveillance_domain.vision.base import Detection
from surveillance_domain.vision.ground import Ground

__all__ = [
    "FloorMarker",
    "FloorPoint",
    "PointFit",
    "PointResidual",
    "judged",
    "marked_points",
    "residuals",
    "root_mean_square",
]


@dataclass(frozen=True)
class FloorMarker:
    """A marker that was laid somewhere for calibration.

    Attributes
    ----------
    number : int
    place_m : (float, float)
        x and y of its centre in metres.
    height_m : float
        How high above the floor it lies.
    """

    number: int
    place_m: tuple[float, float]
    height_m: float = 0.0


@dataclass(frozen=True)
class FloorPoint:
    """A known point in a picture.

    Attributes
    ----------
    name : str
        For messages.
    preset : str
        The preset at which the picture was taken.
    pixel : (float, float)
        ``u`` to the right, ``v`` down, in a picture of the size that the site gives.
    place_m : (float, float)
        x and y in metres.
    height_m : float
        Above the floor.
    marker : int or None
        The number of the marker that it is the middle of, if it is one.
    """

    name: str
    preset: str
    pixel: tuple[float, float]
    place_m: tuple[float, float]
    height_m: float = 0.0
    marker: int | None = None


@dataclass(frozen=True)
class PointResidual:
    """How well one point fits.

    Attributes
    ----------
    point : FloorPoint
    pixels, metres : float
        Distance between where it was seen and where it should be, in the picture and on its own level; nan where the
        calibration does not see it at all.
    fits : bool
        Whether the fit counts it in.
    """

    point: FloorPoint
    pixels: float
    metres: float
    fits: bool = True


@dataclass(frozen=True, eq=False)
class PointFit:
    """What was fitted to points.

    Attributes
    ----------
    points : tuple of PointResidual
        All that were given; those that do not fit are not counted in.
    """

    points: tuple[PointResidual, ...]

    @property
    def residual_px(self) -> float:
        """Root mean square over the points that fit, in pixels."""
        return root_mean_square([one.pixels for one in self.points if one.fits])

    @property
    def residual_m(self) -> float:
        """Root mean square over the points that fit, in metres."""
        return root_mean_square([one.metres for one in self.points if one.fits])


def marked_points(
    preset: str, detections: Sequence[Detection], markers: Mapping[int, FloorMarker]
) -> tuple[FloorPoint, ...]:
    """The markers of known places that were seen at a preset."""
    seen = {one.identity: one.pixel for one in detections if isinstance(one.identity, int)}
    return tuple(
        FloorPoint(f"marker {number} at {preset}", preset, seen[number], marker.place_m, marker.height_m, number)
        for number, marker in markers.items()
        if number in seen
    )


def residuals(points: Sequence[FloorPoint], grounds: Mapping[str, Ground]) -> tuple[PointResidual, ...]:
    """How well each point fits what its preset's picture is taken to show of the floor."""
    return tuple(_residual(point, grounds[point.preset]) for point in points)


def _residual(point: FloorPoint, ground: Ground) -> PointResidual:
    place, pixel, height = np.array([point.place_m]), np.array([point.pixel]), np.array([point.height_m])
    pixels = float(np.linalg.norm(ground.in_picture(place, height) - pixel))
    metres = float(np.linalg.norm(ground.on_floor(pixel, height) - place))
    return PointResidual(point, pixels, metres)


def root_mean_square(errors: Sequence[float]) -> float:
    """Nan for none, and where one is nan."""
    return float(np.sqrt(np.mean(np.square(errors)))) if len(errors) else float("nan")


def judged(found: Sequence[PointResidual], fits: Bool[np.ndarray, " points"]) -> tuple[PointResidual, ...]:
    """The same, those marked that the fit counts in."""
    return tuple(replace(one, fits=bool(good)) for one, good in zip(found, fits, strict=True))
