"""Whether a body is a whole picture."""

from __future__ import annotations

from io import BytesIO

from surveillance_domain.cameras.answers import refusal
from surveillance_domain.cameras.errors import BadPicture, Refused

__all__ = ["jpeg_size"]

_MAGIC = b"\xff\xd8\xff"
_MOST_PIXELS = 50_000_000


def jpeg_size(body: bytes) -> tuple[int, int]:
    """Width and height of a JPEG that was decoded to its end.

    Raises
    ------
    Refused
        If the body is the text of a refusal.
    BadPicture
        If it is no JPEG, is broken or cut short, or has more than 50 million pixels.
    """
    if not body.startswith(_MAGIC):
        reason = refusal(body[:1000].decode("utf-8", errors="replace"))
        if reason is not None:
            raise Refused(f"the camera refuses a picture: {reason}")
        raise BadPicture(f"no JPEG: {len(body):,} bytes that begin with {body[:8]!r}")
    size, why = _decoded(body)
    if size is None:
        raise BadPicture(f"a JPEG of {len(body):,} bytes that cannot be decoded: {why}")
    return size


def _decoded(body: bytes) -> tuple[tuple[int, int] | None, str]:
    from PIL import Image

    try:
        with Image.open(BytesIO(body), formats=["JPEG"]) as picture:
            width, height = picture.size
            if width * height > _MOST_PIXELS:
                return None, f"{width} x {height} pixels"
            picture.load()
    except Exception as error:  # Pillow meets broken data with errors of a dozen kinds
        return None, str(error) or type(error).__name__
    return (width, height), ""
