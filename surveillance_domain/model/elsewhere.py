"""What a camera sees that stands still at none of its presets, because people have turned it there.

Camera variables of the model hold presets only, so such a view is no value of theirs. It is a view all the same
(model.md, "Known variables and actual views"): by the same optics, walls and masks as a preset's.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from surveillance_domain.model.privacy import looks_into_private
from surveillance_domain.model.views import fields_of_view
from surveillance_domain.site.site import Site

__all__ = ["Elsewhere", "Place"]

Place = tuple[float, float, float]
"""Pan and tilt in degrees, and zoom, in the camera's own numbers."""


class Elsewhere:
    """Views of a site's cameras at places that are no presets; the last one of each camera is kept."""

    def __init__(self, site: Site) -> None:
        self._site = site
        self._cameras = {camera.name: camera for camera in site.cameras}
        self._kept: dict[str, tuple[Place, Float[np.ndarray, " cells"] | None]] = {}

    def detection(self, camera: str, place: Place) -> Float[np.ndarray, " cells"] | None:
        """Probability that the camera detects a target in each free cell; ``None``: it looks into a private area."""
        if camera not in self._kept or self._kept[camera][0] != place:
            self._kept[camera] = (place, self._worked_out(camera, place))
        return self._kept[camera][1]

    def missed(self, places: Mapping[str, Place]) -> Float[np.ndarray, " cells"]:
        """Probability that none of some cameras detects a target in each free cell."""
        missed = np.ones(self._site.grid.size)
        for camera, place in places.items():
            detected = self.detection(camera, place)
            if detected is not None:
                missed = missed * (1 - detected)
        return missed

    def _worked_out(self, camera: str, place: Place) -> Float[np.ndarray, " cells"] | None:
        described = self._cameras[camera]
        pan, tilt, zoom = place
        preset = described.presets[0].model_copy(update={"pan": pan, "tilt": tilt, "zoom": zoom, "homography": None})
        if looks_into_private(self._site, described, preset):
            return None
        (seen,) = fields_of_view(self._site.grid, described, [preset])
        return seen * described.detection_probability
