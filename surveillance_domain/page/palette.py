"""Colours of the page: those of the printed pictures."""

from __future__ import annotations

import numpy as np

from surveillance_domain.pictures.scene import HEAT_COLOURS
from surveillance_domain.pictures.style import CAMERA_COLOURS

__all__ = ["camera_colour", "heat_palette"]


def camera_colour(index: int) -> str:
    """Of a camera, by its number at the site."""
    return CAMERA_COLOURS[index % len(CAMERA_COLOURS)]


def heat_palette(size: int) -> list[str]:
    """Colours for 0 to 1 in equal steps, that grow darker with the square root: small numbers are told apart, too."""
    anchors = np.array([[int(colour[at : at + 2], 16) for at in (1, 3, 5)] for colour in HEAT_COLOURS])
    at = np.sqrt(np.linspace(0, 1, size))
    ends = np.linspace(0, 1, len(anchors))
    rgb = np.stack([np.interp(at, ends, channel) for channel in anchors.T], axis=1)
    return ["#{:02x}{:02x}{:02x}".format(*row) for row in np.rint(rgb).astype(int).tolist()]
