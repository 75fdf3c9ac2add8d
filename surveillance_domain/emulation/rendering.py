"""Pictures of an emulated site: what a pinhole sees of floor, walls and targets, with the noise of its sensor."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, UInt8

from surveillance_domain.emulation.canvas import Canvas
from surveillance_domain.emulation.mask_painting import MaskPainter
from surveillance_domain.emulation.solids import Face, box, level_square, walls
from surveillance_domain.emulation.textures import MARKER_SHARE, floor, marker_top
from surveillance_domain.model.looks import Look
from surveillance_domain.model.pinhole import Pinhole
from surveillance_domain.site.site import Site
from surveillance_domain.vision.points import FloorMarker

__all__ = ["Renderer"]

_WALL_M = 2.4
_WALL = (205, 198, 184)
_BEYOND = (90, 84, 78)
_PERSON_SIDE_M, _PERSON_HEIGHT_M = 0.45, 1.7
_PAPER = (255, 255, 255)
_SPARE = 256
_MOST_FLOORS = 12


class Renderer:
    """Draws a site.

    Targets are boxes: where the site has markers, as high as those lie and 1 / 0.6 of a marker wide, with the marker
    on the coloured top, its upper edge to the left of where the target heads; otherwise as large as people.

    Parameters
    ----------
    site : Site
    looks : sequence of Look
        Of the targets.
    rng : numpy.random.Generator
        For the texture of the floor and the noise.
    noise : float
        Standard deviation of a pixel, of 255.
    laid : sequence of FloorMarker
        Markers on white sheets, upright as seen from the lower edge of the map; where the site has markers.
    """

    def __init__(
        self,
        site: Site,
        looks: Sequence[Look],
        rng: np.random.Generator,
        noise: float = 3.0,
        laid: Sequence[FloorMarker] = (),
    ) -> None:
        self._looks, self._rng, self._noise = tuple(looks), rng, noise
        self._grain: dict[tuple[int, int], np.ndarray] = {}
        self._floor = floor(site.grid, rng)
        self._floors: dict[tuple[bytes, int, int], np.ndarray] = {}
        self._entropy = int(rng.integers(2**63))
        self._standing = walls(site.grid, _WALL_M, _WALL)
        self._side_m, self._height_m = _PERSON_SIDE_M, _PERSON_HEIGHT_M
        self._tops: list[np.ndarray | None] = [None] * len(self._looks)
        if site.markers is not None:
            self._side_m = site.markers.side_m / MARKER_SHARE
            self._height_m = max(site.markers.height_m, 1e-3)
            dictionary = site.markers.dictionary
            self._tops = [None if k.marker is None else marker_top(dictionary, k.marker, k.colour) for k in self._looks]
            self._standing += tuple(_sheet(one, dictionary, self._side_m) for one in laid)

    def picture(
        self,
        pinhole: Pinhole,
        places_m: Float[np.ndarray, "targets 2"],
        headings_rad: Float[np.ndarray, " targets"],
        luck: np.random.Generator | None = None,
    ) -> UInt8[np.ndarray, "height width 3"]:
        """What the camera sees, blue, green and red.

        Parameters
        ----------
        pinhole : Pinhole
        places_m : (targets, 2) float
            x and y in metres; nan for those that are not there.
        headings_rad : (targets,) float
            Counter-clockwise from +x.
        luck : numpy.random.Generator, optional
            For the noise of this picture, instead of the renderer's own: where several cameras take pictures at once,
            each with its own draws the same noise whoever comes first.
        """
        canvas = Canvas(pinhole, *self._ground(pinhole))
        for face in (*self._standing, *self._targets(places_m, headings_rad)):
            canvas.paint(face)
        return self._sensed(canvas.picture, self._rng if luck is None else luck)

    def jpeg(
        self,
        pinhole: Pinhole,
        places_m: Float[np.ndarray, "targets 2"],
        headings_rad: Float[np.ndarray, " targets"],
        compression: int = 20,
        luck: np.random.Generator | None = None,
        masks: MaskPainter | None = None,
    ) -> bytes:
        """The same as a JPEG; ``compression`` goes from 0 to 100, as cameras count it; the camera's masks are black."""
        import cv2

        picture = self.picture(pinhole, places_m, headings_rad, luck)
        if masks is not None:
            masks.paint(pinhole, picture)
        quality = [cv2.IMWRITE_JPEG_QUALITY, max(5, 100 - compression)]
        _, encoded = cv2.imencode(".jpg", picture, quality)
        return encoded.tobytes()

    def _targets(
        self, places_m: Float[np.ndarray, "targets 2"], headings_rad: Float[np.ndarray, " targets"]
    ) -> list[Face]:
        faces: list[Face] = []
        for look, top, place, heading in zip(self._looks, self._tops, places_m, headings_rad, strict=True):
            if np.isfinite(place).all():
                faces += box(place, float(heading), self._side_m, self._height_m, look.colour, top)
        return faces

    def _ground(self, pinhole: Pinhole) -> tuple[np.ndarray, np.ndarray]:
        """The floor up to the horizon, and 1 / depth of every pixel of it; to be painted over.

        Cameras look from the same places again and again, so the last few floors are kept.
        """
        to_floor = pinhole.homography()
        u, v = np.arange(pinhole.width), np.arange(pinhole.height)
        inverse_depth = to_floor[2, 0] * u[None, :] + to_floor[2, 1] * v[:, None] + to_floor[2, 2]
        key = pinhole.projection.tobytes(), pinhole.width, pinhole.height
        seen = self._floors.pop(key, None)
        if seen is None:
            seen = self._seen_floor(to_floor, (pinhole.width, pinhole.height))
            seen[inverse_depth <= 0] = _BEYOND[::-1]
        self._floors[key] = seen
        for oldest in list(self._floors)[:-_MOST_FLOORS]:
            self._floors.pop(oldest, None)
        return seen.copy(), np.maximum(inverse_depth, 0.0)

    def _seen_floor(self, to_floor: Float[np.ndarray, "3 3"], size: tuple[int, int]) -> np.ndarray:
        import cv2

        (x, y), scale = self._floor.corner_m, self._floor.px_per_m
        rows = self._floor.texture.shape[0]
        to_texture = np.array([[scale, 0, -x * scale - 0.5], [0, -scale, rows + y * scale - 0.5], [0, 0, 1]]) @ to_floor
        return cv2.warpPerspective(
            self._floor.texture,
            to_texture,
            size,
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=cv2.BORDER_CONSTANT,
            borderValue=_BEYOND[::-1],
        )

    def _sensed(self, picture: np.ndarray, luck: np.random.Generator) -> np.ndarray:
        """With noise, each time another cutting of one large sheet of it."""
        import cv2

        if self._noise == 0:
            return picture
        height, width = picture.shape[:2]
        top, left = luck.integers(0, _SPARE, size=2)
        grain = self._grain_of(height + _SPARE, width + _SPARE)
        return cv2.add(picture, grain[top : top + height, left : left + width], dtype=cv2.CV_8U)

    def _grain_of(self, height: int, width: int) -> np.ndarray:
        """Noise, the same for pictures of one size, whoever asks for it first."""
        if (height, width) not in self._grain:
            rng = np.random.default_rng([self._entropy, height, width])
            noise = self._noise * rng.standard_normal((height, width, 3), dtype=np.float32)
            self._grain[height, width] = np.rint(noise).astype(np.int16)
        return self._grain[height, width]


def _sheet(marker: FloorMarker, dictionary: str, side_m: float) -> Face:
    """A white sheet with a marker in its middle."""
    texture = marker_top(dictionary, marker.number, _PAPER)
    return level_square(np.array(marker.place_m), side_m, marker.height_m, _PAPER, texture)
