"""Eyes that look at pictures: detections go to the floor, to a cell, to a target."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from surveillance_domain.cameras.base import Camera, Picture
from surveillance_domain.cameras.errors import BadPicture
from surveillance_domain.model.build import Surveillance
from surveillance_domain.model.elsewhere import Place
from surveillance_domain.model.looks import looks
from surveillance_domain.vision.aruco import MarkerDetector
from surveillance_domain.vision.base import Detector
from surveillance_domain.vision.blobs import BlobDetector
from surveillance_domain.vision.ground import ground
from surveillance_domain.vision.masks import unmasked
from surveillance_domain.vision.observe import Located, Observed, Observer, located
from surveillance_domain.vision.opencv import BadImage, decoded, opencv
from surveillance_domain.world.eyes import Look

__all__ = ["PictureEyes", "Sight"]

_PERSON_M = 1.7
"""Height of a target that is known by its colours."""


@dataclass(frozen=True, eq=False)
class Sight:
    """A picture and what was found in it."""

    picture: Picture
    located: tuple[Located, ...]


class PictureEyes:
    """Finds a site's targets by their markers, or by their colours where it has none.

    What a declared privacy mask covers is not used, whether the camera blackens it or not.

    Parameters
    ----------
    surveillance : Surveillance
    detector : Detector, optional
        Instead of these.

    Attributes
    ----------
    last : Observed or None
        Of the last step, with what was found but not used.
    sights : dict of str to Sight
        Of the last step, by camera.
    """

    def __init__(self, surveillance: Surveillance, detector: Detector | None = None) -> None:
        self._failures = (BadImage, opencv().error)
        site, known = surveillance.site, looks(surveillance.site, len(surveillance.targets))
        self._site = site
        self._described = {camera.name: camera for camera in site.cameras}
        if detector is not None:
            self._detector: Detector = detector
        elif site.markers is not None:
            self._detector = MarkerDetector(site.markers)
        else:
            self._detector = BlobDetector({look.name: look.colour for look in known}, _PERSON_M)
        identities: dict[int | str, str] = {look.name: look.name for look in known}
        identities |= {look.marker: look.name for look in known if look.marker is not None}
        self._observer = Observer(site, surveillance.views, surveillance.targets, identities)
        self.last: Observed | None = None
        self.sights: dict[str, Sight] = {}

    def look(self, camera: Camera, budget_s: float) -> Look:
        picture = camera.picture(budget_s)
        try:
            detections = self._detector.detect(decoded(picture.jpeg))
        except self._failures as problem:
            raise BadPicture(f"{camera.name}: {problem}") from None
        described, size = self._described[camera.name], (picture.width, picture.height)
        shown = unmasked(described, picture.position, size, detections)
        found = located(ground(described, picture.position, size), self._site.grid, shown)
        return Look(picture.position, Sight(picture, found))

    def seen(
        self, looks: Mapping[str, Look], views: Mapping[str, str | None], elsewhere: Mapping[str, Place]
    ) -> Observed:
        self.sights = {name: look.found for name, look in looks.items()}
        found = {name: sight.located for name, sight in self.sights.items()}
        self.last = self._observer.observe(found, views, elsewhere)
        return self.last
