"""What a site's targets look like from above: their colours, and the markers by which pictures tell them apart."""

from __future__ import annotations

import colorsys
from dataclasses import dataclass

from surveillance_domain.model.build import target_names
from surveillance_domain.site.site import Site

__all__ = ["Look", "looks"]

_GOLDEN = 0.618033988749895


@dataclass(frozen=True)
class Look:
    """How a target looks.

    Attributes
    ----------
    name : str
    marker : int or None
        Number of its ArUco marker; ``None`` where the site has no markers.
    colour : (int, int, int)
        Red, green and blue, 0 to 255.
    """

    name: str
    marker: int | None
    colour: tuple[int, int, int]


def looks(site: Site, targets: int) -> tuple[Look, ...]:
    """The looks of all targets, in the order of `surveillance_domain.model.build.target_names`.

    A target carries the marker that the site gives it, others the lowest numbers that are left. It has the colour that
    the site gives it, or else the one it is named for; the others' hues are spread by the golden section.
    """
    names = target_names(site, targets)
    given = {target.name: target.marker for target in site.targets.known if target.marker is not None}
    free = (number for number in range(targets + len(given)) if number not in given.values())
    colours = {target.name: target.color for target in site.targets.known}
    markers = [given[name] if name in given else next(free) for name in names]
    return tuple(
        Look(name, marker if site.markers is not None else None, _colour(colours.get(name) or name, number))
        for number, (name, marker) in enumerate(zip(names, markers, strict=True))
    )


def _colour(name_or_code: str, number: int) -> tuple[int, int, int]:
    from PIL import ImageColor

    try:
        red, green, blue = ImageColor.getrgb(name_or_code)[:3]
    except ValueError:
        red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(number * _GOLDEN % 1.0, 0.75, 0.85))
    return red, green, blue
