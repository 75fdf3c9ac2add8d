"""A run as a moving picture: map, fields of view, belief as a heat map, and where the targets really are."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from surveillance_domain.model.views import Views
from surveillance_domain.pictures.scene import Frame, draw_scene
from surveillance_domain.site.site import Site

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from PIL.Image import Image

__all__ = ["draw_frame", "write_animation"]

_DOTS_PER_INCH = 110
_FRAME_MS = 250
_LAST_FRAME_MS = 2000
_MOST_FRAMES = 200
_COLOURS = 256
_EVERY = 3


def draw_frame(site: Site, views: Views, frame: Frame, heading: str) -> Figure:
    """One step as a figure of its own."""
    return draw_scene(site, views, frame, heading).figure


def write_animation(site: Site, views: Views, frames: Sequence[Frame], heading: str, path: Path) -> None:
    """Write the frames as a GIF that repeats for ever, whole or not at all.

    Of more than 200 frames every second one is shown, or every third, and so on; the last one always.

    Raises
    ------
    ValueError
        Without frames.
    OSError
        If the file cannot be written.
    """
    if not frames:
        raise ValueError("an animation needs a frame at least")
    stride = -(-len(frames) // _MOST_FRAMES)
    shown = [*frames[:-1:stride], frames[-1]]
    pictures = _with_common_colours(_rendered(site, views, shown, heading))
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            durations = [_FRAME_MS] * (len(pictures) - 1) + [_LAST_FRAME_MS]
            pictures[0].save(
                file, "GIF", save_all=True, append_images=pictures[1:], duration=durations, loop=0, optimize=False
            )
        os.chmod(name, 0o644)
        os.replace(name, path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _rendered(site: Site, views: Views, frames: Sequence[Frame], heading: str) -> list[Image]:
    """The frames as pictures; what stands still is drawn once."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from PIL import Image

    scene = draw_scene(site, views, frames[0], heading)
    scene.figure.set_dpi(_DOTS_PER_INCH)
    canvas: Any = FigureCanvasAgg(scene.figure)
    for artist in scene.moving:
        artist.set_animated(True)
    canvas.draw()
    still = canvas.copy_from_bbox(scene.figure.bbox)
    pictures = []
    for frame in frames:
        scene.show(frame)
        canvas.restore_region(still)
        for artist in scene.moving:
            scene.axes.draw_artist(artist)
        pictures.append(Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy()))
    return pictures


def _with_common_colours(pictures: Sequence[Image]) -> list[Image]:
    """All pictures on one palette, of the commonest colours of all: areas stay true, what does not move is small."""
    from PIL import Image

    samples = [np.asarray(picture)[::_EVERY, ::_EVERY].reshape(-1, 3).astype(np.int64) for picture in pictures]
    packed = np.concatenate([red << 16 | green << 8 | blue for red, green, blue in (sample.T for sample in samples)])
    colours, counts = np.unique(packed, return_counts=True)
    common = colours[np.argsort(-counts, kind="stable")[:_COLOURS]]
    palette = Image.new("P", (1, 1))
    palette.putpalette(np.stack([common >> 16, common >> 8 & 255, common & 255], axis=1).astype(np.uint8).tobytes())
    return [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
