"""The last picture of each camera, with what was found in it."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape

from surveillance_domain.page.palette import camera_colour
from surveillance_domain.page.snapshot import Mark, PictureSnapshot

__all__ = ["gallery"]

_TEXT_SHARE = 0.045
"""Size of labels, of the picture's width."""


def gallery(names: Sequence[str], pictures: Mapping[str, PictureSnapshot], step: int) -> str:
    """HTML of the pictures, in the site's order; one that is not of this step is dimmed and says how old it is.

    Pictures are in the page itself: they are stored nowhere.
    """
    return "".join(_figure(number, name, pictures.get(name), step) for number, name in enumerate(names))


def _figure(number: int, name: str, picture: PictureSnapshot | None, step: int) -> str:
    colour = f'<i style="background:{camera_colour(number)}"></i>'
    if picture is None:
        return f'<figure class="none"><figcaption>{colour}{escape(name)}: no picture yet</figcaption></figure>'
    width, height = picture.size
    old = step - picture.step
    age = "" if old == 0 else f", {old} step{'s' if old > 1 else ''} ago"
    marks = "".join(_mark(mark, width) for mark in picture.marks)
    source = f"data:image/jpeg;base64,{b64encode(picture.jpeg).decode('ascii')}"
    alt = f"What camera {escape(name)} saw in step {picture.step}"
    return (
        f'<figure class="{"old" if old else "now"}"><div>'
        f'<img src="{source}" width="{width}" height="{height}" alt="{alt}">'
        f'<svg viewBox="0 0 {width} {height}" aria-hidden="true">{marks}</svg></div>'
        f"<figcaption>{colour}{escape(name)}, step {picture.step}{age}</figcaption></figure>"
    )


def _mark(mark: Mark, width: int) -> str:
    """A ring about a detection, and beside it who it is."""
    u, v = mark.pixel
    radius, text = max(mark.size_px, 0.02 * width), _TEXT_SHARE * width
    return (
        f'<circle cx="{u:.1f}" cy="{v:.1f}" r="{radius:.1f}"/>'
        f'<text x="{u + radius:.1f}" y="{v - radius:.1f}" font-size="{text:.0f}">{escape(mark.label)}</text>'
    )
