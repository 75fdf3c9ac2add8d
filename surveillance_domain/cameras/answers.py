"""What AXIS cameras answer: lines of ``key=value``, of which any may be missing, or a body that says ``Error:``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from surveillance_domain.cameras.base import Limits, Position
from surveillance_domain.cameras.errors import BadAnswer, Refused

__all__ = ["image_size", "key_values", "limits", "position", "refusal", "zoom_steps"]

_SHOWN = 120
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


def refusal(body: str) -> str | None:
    """Why a camera refuses, whatever its status says; ``None`` if it does not.

    A refusal begins with a line ``Error:``, as before ``query: unknown value: X``; one for a channel that is not there
    is an HTML comment, as in ``<!--Camera 1 not available.-->``.
    """
    text = body.strip()
    if text.lower().startswith("error"):
        return _one_line(text.partition(":")[2]) or "Error"
    if text.startswith("<!--") and "not available" in text:
        return _one_line(text.removeprefix("<!--").partition("-->")[0])
    return None


def key_values(body: str) -> dict[str, str]:
    """The lines of an answer; those without ``=`` are passed over, of equal keys the last counts.

    Raises
    ------
    Refused
        If the body is a refusal.
    """
    reason = refusal(body)
    if reason is not None:
        raise Refused(f"the camera refuses: {reason}")
    pairs = (line.partition("=") for line in re.split(r"[\r\n]+", body))
    return {key.strip(): value.strip() for key, equals, value in pairs if equals and key.strip()}


def position(body: str) -> Position:
    """The answer to ``query=position``; 0.0 is a value, and ``zoom`` may be missing.

    Raises
    ------
    Refused
        If the body is a refusal.
    BadAnswer
        If pan or tilt is missing, or anything is no finite number.
    """
    found = key_values(body)
    pan, tilt, zoom = (_number(found, key) for key in ("pan", "tilt", "zoom"))
    if pan is None or tilt is None:
        raise BadAnswer(f"expected lines pan=… and tilt=…, found {_shown(body)}")
    return Position(pan, tilt, zoom)


def limits(body: str) -> Limits:
    """The answer to ``query=limits``; an axis of which either end is missing is not limited.

    Raises
    ------
    Refused
        If the body is a refusal.
    BadAnswer
        If none of pan, tilt and zoom is there, an end is no finite number, or the least is above the greatest.
    """
    found = key_values(body)
    pan, tilt, zoom = (_range(found, axis) for axis in ("Pan", "Tilt", "Zoom"))
    if pan is None and tilt is None and zoom is None:
        raise BadAnswer(f"expected lines such as MinPan=-170 and MaxPan=170, found {_shown(body)}")
    return Limits(pan, tilt, zoom)


def image_size(body: str) -> tuple[int, int]:
    """The answer of ``imagesize.cgi``: width and height in pixels.

    Raises
    ------
    Refused
        If the body is a refusal, such as that of a channel that is not there.
    BadAnswer
        If width or height is missing or not a whole number above 0.
    """
    found = key_values(body)
    width, height = (_number(found, key) for key in ("image width", "image height"))
    if width is None or height is None or not (width.is_integer() and height.is_integer() and min(width, height) > 0):
        raise BadAnswer(f"expected lines image width = … and image height = …, found {_shown(body)}")
    return int(width), int(height)


def zoom_steps(attributes: Mapping[str, str]) -> tuple[tuple[float, float], ...]:
    """Pairs of zoom position and magnification from the answer to ``query=attributes``; empty if it has none.

    Firmwares put different signs between the numbers, so only the numbers count.
    """
    numbers = [float(text) for text in re.findall(_NUMBER, attributes.get("zoomSteps", ""))]
    return tuple(zip(numbers[::2], numbers[1::2], strict=False))


def _range(found: Mapping[str, str], axis: str) -> tuple[float, float] | None:
    low, high = _number(found, f"Min{axis}"), _number(found, f"Max{axis}")
    if low is None or high is None:
        return None
    if low > high:
        raise BadAnswer(f"expected Min{axis} up to Max{axis}, found {low:g} to {high:g}")
    return low, high


def _number(found: Mapping[str, str], key: str) -> float | None:
    """The value of a key as a finite number; ``None`` if the key is missing."""
    if key not in found:
        return None
    text = found[key]
    value = float(text) if re.fullmatch(_NUMBER, text) else math.nan
    if not math.isfinite(value):
        raise BadAnswer(f"expected a number for {key}, found {_shown(text)}")
    return value


def _shown(text: str) -> str:
    line = _one_line(text)
    return repr(line if len(line) <= _SHOWN else line[:_SHOWN] + "…") if line else "nothing"


def _one_line(text: str) -> str:
    return " ".join(text.split())
