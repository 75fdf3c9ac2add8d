"""Between floor and pixels: where a point projects in a camera's picture, and which point a pixel shows.

Pixels are counted as OpenCV counts them: ``u`` to the right, ``v`` down, whole numbers at the centres of pixels, so a
picture covers -0.5 to width - 0.5. The optical axis goes through the middle of the picture, and pixels are square:
with forward, left and up of the camera's frame (see `surveillance_domain.model.optics`),

    u = (width - 1) / 2 - focal · left / forward,    v = (height - 1) / 2 - focal · up / forward,

with ``focal = width / (2 tan(hfov / 2))`` pixels. Lenses do not distort here.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.optics import horizontal_fov_deg, orientation
from surveillance_domain.site.camera import Camera

__all__ = ["Pinhole", "pinhole"]

_NEAREST_M = 1e-6


@dataclass(frozen=True, eq=False)
class Pinhole:
    """A camera that looks somewhere.

    Attributes
    ----------
    position_m : (3,) float
        Where it hangs, in the world.
    axes : (3, 3) float
        Its forward, left and up in the world, as columns.
    focal_px : float
        Focal length in pixels.
    width, height : int
        Size of the picture in pixels.
    """

    position_m: Float[np.ndarray, "3"]
    axes: Float[np.ndarray, "3 3"]
    focal_px: float
    width: int
    height: int

    @property
    def centre_px(self) -> tuple[float, float]:
        """The pixel that the optical axis goes through."""
        return (self.width - 1) / 2, (self.height - 1) / 2

    @property
    def projection(self) -> Float[np.ndarray, "3 4"]:
        """``P`` with ``(u, v, 1) ~ P (x, y, z, 1)``; the third component is the distance along the optical axis."""
        forward, left, up = self.axes.T
        (u, v), focal = self.centre_px, self.focal_px
        rows = np.stack([u * forward - focal * left, v * forward - focal * up, forward])
        return np.hstack([rows, -(rows @ self.position_m)[:, None]])

    def project(self, points_m: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 2"]:
        """Pixels of points in the world; nan for those that are not a micrometre or more in front of it."""
        seen = (points_m - self.position_m) @ self.axes
        forward = np.where(seen[:, 0] > _NEAREST_M, seen[:, 0], np.nan)
        u, v = self.centre_px
        return np.stack([u - self.focal_px * seen[:, 1] / forward, v - self.focal_px * seen[:, 2] / forward], axis=1)

    def rays(self, pixels: Float[np.ndarray, "points 2"]) -> Float[np.ndarray, "points 3"]:
        """Directions in the world in which pixels look, of length 1 along the optical axis."""
        left_up = (np.asarray(self.centre_px) - pixels) / self.focal_px
        return np.column_stack([np.ones(len(pixels)), left_up]) @ self.axes.T

    def on_plane(self, pixels: Float[np.ndarray, "points 2"], height_m: float = 0.0) -> Float[np.ndarray, "points 2"]:
        """Where in the world pixels look at a level plane, x and y in metres; nan for those that do not meet it."""
        rays = self.rays(pixels)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = (height_m - self.position_m[2]) / rays[:, 2]
            distance = np.where(np.isfinite(distance) & (distance > 0), distance, np.nan)
        return self.position_m[:2] + distance[:, None] * rays[:, :2]

    def homography(self, height_m: float = 0.0) -> Float[np.ndarray, "3 3"]:
        """``H`` from picture to a level plane: ``(x, y, 1) ~ H (u, v, 1)``, pixels that see the plane having ``w > 0``.

        Raises
        ------
        ValueError
            If the camera lies in the plane, which it then sees edge on.
        """
        rows = self.projection
        flat = np.column_stack([rows[:, 0], rows[:, 1], rows[:, 2] * height_m + rows[:, 3]])
        if self.position_m[2] == height_m:
            raise ValueError(f"a camera at height {height_m:g} m sees the plane at that height edge on")
        return np.linalg.inv(flat)


def pinhole(
    camera: Camera, pan_deg: float, tilt_deg: float, zoom: float, size: tuple[int, int] | None = None
) -> Pinhole:
    """The pinhole of a camera that looks somewhere, by its own read-back numbers.

    Parameters
    ----------
    camera : Camera
        Mount, picture and field of view across zoom.
    pan_deg, tilt_deg : float
        In the camera's own numbers.
    zoom : float
        Zoom position.
    size : (int, int), optional
        Width and height of the picture in pixels, where they are not what the site says.
    """
    width, height = size or (camera.image.width, camera.image.height)
    half = np.radians(horizontal_fov_deg(camera.zoom_hfov, zoom)) / 2
    axes = orientation(camera.mount, pan_deg, tilt_deg)
    position = np.asarray(camera.mount.position_m, dtype=np.float64)
    return Pinhole(position, axes, float(width / (2 * np.tan(half))), width, height)
