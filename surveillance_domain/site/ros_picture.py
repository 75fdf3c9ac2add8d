"""The picture of a ROS map_server map: its lightness, averaged over channels as map_server does."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from surveillance_domain.site.faults import Fault
from surveillance_domain.site.ros_header import RosMapError

__all__ = ["read_ros_picture"]

_MOST_PIXELS = 50_000_000
_MOST_BYTES = 500_000_000
_FORMATS = ("PPM", "PNG", "BMP")


def read_ros_picture(
    path: Path, alpha_counts: bool
) -> tuple[Float[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"], bytes]:
    """Lightness (0 black to 255 white), which pixels are opaque, and the file's bytes; row 0 is the top.

    With ``alpha_counts`` the alpha channel is averaged in like a colour (map_server's trinary mode).

    Raises
    ------
    RosMapError
        If the picture is missing, damaged, of another format, or larger than 50 million pixels (found out before
        it is decoded).
    """
    from PIL import Image, UnidentifiedImageError

    content = _content(path)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(io.BytesIO(content), formats=_FORMATS) as picture:
                if picture.width * picture.height > _MOST_PIXELS:
                    raise Image.DecompressionBombError
                return *_channels(picture, alpha_counts), content
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise _wrong(path, "a larger picture", "at most 50 million pixels") from None
    except UnidentifiedImageError:
        raise _wrong(path, "a damaged file, or none of these formats", "a PGM (P2 or P5), PNG or BMP picture") from None
    except (OSError, ValueError, SyntaxError, EOFError) as error:
        raise _wrong(path, f"a damaged picture ({error})", "a whole PGM, PNG or BMP picture") from None


def _wrong(path: Path, found: str, expected: str) -> RosMapError:
    return RosMapError(str(path), (Fault("", found, expected),))


def _content(path: Path) -> bytes:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise _wrong(path, f"{path.stat().st_size} bytes", f"at most {_MOST_BYTES} bytes")
        return path.read_bytes()
    except OSError as error:
        found = "no such file" if isinstance(error, FileNotFoundError) else (error.strerror or "no access").lower()
        raise _wrong(path, found, "the map's picture") from None


def _channels(picture: Any, alpha_counts: bool) -> tuple[np.ndarray, np.ndarray]:
    if picture.mode.startswith("I") or picture.mode == "F":  # more than 8 bits a channel
        lightness = np.asarray(picture, dtype=np.float64) * (255 / 65535)
        return lightness, np.ones(lightness.shape, dtype=bool)
    has_alpha = "A" in picture.mode or "transparency" in picture.info
    pixels = np.asarray(picture.convert("RGBA" if has_alpha else "RGB"))
    opaque = pixels[..., 3] == 255 if has_alpha else np.ones(pixels.shape[:2], dtype=bool)
    counted = pixels if alpha_counts else pixels[..., :3]
    return counted.mean(axis=2, dtype=np.float64), opaque
