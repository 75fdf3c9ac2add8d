"""OpenCV, which only those who look at pictures need; and pictures as they come from a camera."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType

import numpy as np
from jaxtyping import UInt8

__all__ = ["BadImage", "VisionMissing", "decoded", "opencv", "read_image", "write_png"]


class VisionMissing(RuntimeError):
    """OpenCV is not installed; the message says how to install it."""


class BadImage(ValueError):
    """Bytes that are no picture."""


def opencv() -> ModuleType:
    """The module ``cv2``.

    Raises
    ------
    VisionMissing
        If it is not installed.
    """
    try:
        import cv2
    except ModuleNotFoundError as problem:
        if problem.name != "cv2":
            raise
        raise VisionMissing("pictures need OpenCV: pip install 'factored-pomdp[vision]'") from None
    module: ModuleType = cv2
    return module


def decoded(content: bytes) -> UInt8[np.ndarray, "height width 3"]:
    """The pixels of a JPEG or PNG: blue, green, red; row 0 is the uppermost.

    Raises
    ------
    BadImage
        If it cannot be decoded.
    """
    cv2 = opencv()
    try:
        pixels = cv2.imdecode(np.frombuffer(content, dtype=np.uint8), cv2.IMREAD_COLOR) if content else None
    except cv2.error:
        pixels = None
    if pixels is None:
        raise BadImage(f"{len(content):,} bytes that are no picture that can be decoded")
    return np.asarray(pixels)


def read_image(path: Path) -> UInt8[np.ndarray, "height width 3"]:
    """The pixels of a picture file.

    Raises
    ------
    BadImage
        Naming the file, if it cannot be read or is no picture.
    """
    try:
        return decoded(path.read_bytes())
    except OSError as problem:
        raise BadImage(f"{path}: {(problem.strerror or str(problem)).lower()}; expected a JPEG or PNG") from None
    except BadImage as problem:
        raise BadImage(f"{path}: {problem}; expected a JPEG or PNG") from None


def write_png(path: Path, picture: UInt8[np.ndarray, "height width 3"]) -> None:
    """Write pixels as a PNG: whole, or not at all."""
    _, encoded = opencv().imencode(".png", picture)
    beside = path.with_name(f".{path.name}.unfinished")
    try:
        beside.write_bytes(encoded.tobytes())
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)
