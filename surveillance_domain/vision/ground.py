"""From pixels to the floor, and back: through a preset's homography, else through the pinhole model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.cameras.base import Position
from surveillance_domain.model.pinhole import Pinhole, pinhole
from surveillance_domain.site.camera import Camera, Preset

__all__ = ["Ground", "ground", "preset_at", "through", "view_at", "zoom_at"]


@dataclass(frozen=True, eq=False)
class Ground:
    """What a picture shows of the floor.

    Attributes
    ----------
    to_floor : (3, 3) float
        ``(x, y, 1) ~ H (u, v, 1)``, in metres and the picture's own pixels; ``w > 0`` for pixels that see the floor.
    camera_m : (3,) float
        Where the camera hangs, in metres.
    size : (int, int)
        Width and height of the picture in pixels.
    calibrated : bool
        Whether a homography of the preset was used.
    """

    to_floor: Float[np.ndarray, "3 3"]
    camera_m: Float[np.ndarray, "3"]
    size: tuple[int, int]
    calibrated: bool

    def on_floor(
        self, pixels: Float[np.ndarray, "points 2"], heights_m: Float[np.ndarray, " points"]
    ) -> Float[np.ndarray, "points 2"]:
        """Where points are that are seen at some pixels and known to be that high above the floor, x and y in metres.

        The ray to a point at height ``h`` meets the floor beyond it, at ``q``; with the camera above ``c`` at height
        ``H`` the point is above ``c + (1 - h / H) (q - c)``. nan for pixels that do not see the floor, and for points
        that are not below the camera.
        """
        floor = through(self.to_floor, pixels)
        camera, height = self.camera_m[:2], self.camera_m[2]
        share = np.where(heights_m < height, 1 - heights_m / height, np.nan)
        return camera + share[:, None] * (floor - camera)

    def in_picture(
        self, points_m: Float[np.ndarray, "points 2"], heights_m: Float[np.ndarray, " points"]
    ) -> Float[np.ndarray, "points 2"]:
        """Pixels of points at some heights above the floor, inside the picture or not; nan for what is behind."""
        camera, height = self.camera_m[:2], self.camera_m[2]
        share = np.where(heights_m < height, 1 - heights_m / height, np.nan)
        return through(np.linalg.inv(self.to_floor), camera + (points_m - camera) / share[:, None])


def ground(camera: Camera, position: Position, size: tuple[int, int]) -> Ground:
    """The floor as a camera sees it that stands still at a position.

    Parameters
    ----------
    camera : Camera
        Mount, optics and presets.
    position : Position
        As it was read back. At a preset that has a homography, that is used; otherwise the pinhole model with the
        position's own numbers. A camera that does not tell its zoom is taken to have that of the nearest preset.
    size : (int, int)
        Width and height of the picture in pixels; a homography belongs to pictures of the site's size and is scaled.
    """
    view = view_at(camera, position, size)
    preset = preset_at(camera, position)
    if preset is None or preset.homography is None:
        return Ground(view.homography(), view.position_m, size, calibrated=False)
    scale = np.array([camera.image.width, camera.image.height]) / size
    to_site = np.array([[scale[0], 0, (scale[0] - 1) / 2], [0, scale[1], (scale[1] - 1) / 2], [0, 0, 1]])
    to_floor = np.array(preset.homography, dtype=float) @ to_site
    return Ground(_seeing_side(to_floor, view), view.position_m, size, calibrated=True)


def view_at(camera: Camera, position: Position, size: tuple[int, int]) -> Pinhole:
    """The pinhole model with a position's own numbers; where it has no zoom, with that of the nearest preset."""
    return pinhole(camera, position.pan, position.tilt, zoom_at(camera, position), size)


def zoom_at(camera: Camera, position: Position) -> float:
    """The zoom of a position; where it has none, that of the nearest preset."""
    if position.zoom is not None:
        return position.zoom
    return min(camera.presets, key=lambda one: abs(one.pan - position.pan) + abs(one.tilt - position.tilt)).zoom


def preset_at(camera: Camera, position: Position) -> Preset | None:
    """The preset at which a camera stands, within its tolerance; ``None``: at none."""
    for preset in camera.presets:
        if position.agrees(Position(preset.pan, preset.tilt, preset.zoom), camera.tolerance_deg):
            return preset
    return None


def through(homography: Float[np.ndarray, "3 3"], points: Float[np.ndarray, "points 2"]) -> np.ndarray:
    """Points mapped by a homography; nan where the third component is not above 0."""
    mapped = np.column_stack([points, np.ones(len(points))]) @ homography.T
    weight = np.where(mapped[:, 2:] > 0, mapped[:, 2:], np.nan)
    result: np.ndarray = mapped[:, :2] / weight
    return result


def _seeing_side(to_floor: Float[np.ndarray, "3 3"], view: Pinhole) -> Float[np.ndarray, "3 3"]:
    """The sign of a homography for which pixels that see the floor, as the pinhole model has it, have ``w > 0``."""
    u, v = np.meshgrid(np.linspace(0, view.width - 1, 9), np.linspace(0, view.height - 1, 9))
    pixels = np.column_stack([u.ravel(), v.ravel()])
    seeing = pixels[np.isfinite(view.on_plane(pixels)[:, 0])]
    weights = np.column_stack([seeing, np.ones(len(seeing))]) @ to_floor[2]
    return -to_floor if np.sign(weights).sum() < 0 else to_floor
