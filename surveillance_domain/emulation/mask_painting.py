"""Black where a camera's privacy masks are, as the camera itself paints it over its pictures."""

from __future__ import annotations

import threading
from collections import OrderedDict

import numpy as np
from jaxtyping import Bool, UInt8

from surveillance_domain.model.pinhole import Pinhole
from surveillance_domain.model.privacy_masks import behind_masks
from surveillance_domain.site.camera import Camera

__all__ = ["MaskPainter"]

_MOST_KEPT = 6


class MaskPainter:
    """Paints one camera's masks.

    Cameras look from the same places again and again, so what the last few hide is kept.

    Parameters
    ----------
    camera : Camera
    """

    def __init__(self, camera: Camera) -> None:
        self._camera = camera
        self._kept: OrderedDict[tuple[bytes, int, int], Bool[np.ndarray, "height width"]] = OrderedDict()
        self._lock = threading.Lock()

    def paint(self, view: Pinhole, picture: UInt8[np.ndarray, "height width 3"]) -> None:
        """Blacken, in place, those pixels of a picture whose middle looks behind a mask."""
        if self._camera.privacy_masks:
            picture[self._hidden(view)] = 0

    def _hidden(self, view: Pinhole) -> Bool[np.ndarray, "height width"]:
        key = view.projection.tobytes(), view.width, view.height
        with self._lock:
            hidden = self._kept.pop(key, None)
            if hidden is None:
                u, v = np.meshgrid(np.arange(view.width), np.arange(view.height))
                pixels = np.column_stack([u.ravel(), v.ravel()]).astype(float)
                hidden = behind_masks(self._camera, view.rays(pixels)).reshape(view.height, view.width)
            self._kept[key] = hidden
            if len(self._kept) > _MOST_KEPT:
                self._kept.popitem(last=False)
        return hidden
