"""The kinds of values that a site file holds.

Every number is strict (no text, no truth value in its place) and finite. A field's description says what would be
right; it becomes the ``expected`` part of a fault, so it is written to follow the word "expected".
"""

from __future__ import annotations

import re
from typing import Annotated
from urllib.parse import urlsplit

from pydantic import AfterValidator, AllowInfNan, BaseModel, ConfigDict, Field, Strict, StringConstraints

__all__ = [
    "Count",
    "Degrees",
    "EnvironmentName",
    "FileName",
    "Flag",
    "Height",
    "Length",
    "Name",
    "Metres",
    "Noise",
    "Number",
    "Point",
    "Position",
    "Positive",
    "Probability",
    "Rate",
    "Section",
    "Seconds",
    "Url",
    "UserName",
]


class Section(BaseModel):
    """A table of the site file: unknown keys are refused, values never change after loading."""

    model_config = ConfigDict(extra="forbid", frozen=True, hide_input_in_errors=True)


def _printable(text: str) -> str:
    if not text.isprintable() or text != text.strip():
        raise ValueError("printable text without space at either end")
    return text


def _url_without_password(text: str) -> str:
    try:
        parts = urlsplit(text)
        port_is_legal = parts.port is None or parts.port > 0
    except ValueError:
        raise ValueError("an address such as http://192.168.0.90") from None
    if "@" in parts.netloc or re.search(r"(?i)pass|pwd", parts.query):
        raise ValueError("an address without user or password; name the variable that holds it in password_env")
    if parts.scheme not in {"http", "https"} or not parts.hostname or not port_is_legal or not text.isprintable():
        raise ValueError("an address such as http://192.168.0.90")
    return text


Number = Annotated[float, Strict(), AllowInfNan(False)]
Flag = Annotated[bool, Strict()]
Count = Annotated[int, Strict()]
Metres = Annotated[Number, Field(ge=-1e6, le=1e6)]
Height = Annotated[Number, Field(ge=0, le=1e4)]
Length = Annotated[Number, Field(gt=0, le=1e5)]
Noise = Annotated[Number, Field(ge=0, le=1e4)]
Positive = Annotated[Number, Field(gt=0, le=1e6)]
Seconds = Annotated[Number, Field(gt=0, le=1e6)]
Rate = Annotated[Number, Field(ge=0, le=1e3)]
Degrees = Annotated[Number, Field(ge=-360, le=360)]
Probability = Annotated[Number, Field(ge=0, le=1)]
Point = tuple[Metres, Metres]
Position = tuple[Metres, Metres, Height]
Name = Annotated[str, StringConstraints(min_length=1, max_length=64), AfterValidator(_printable)]
FileName = Annotated[str, StringConstraints(min_length=1, max_length=4096), AfterValidator(_printable)]
UserName = Annotated[
    str, StringConstraints(min_length=1, max_length=64, pattern=r"^[^:\s]+$"), AfterValidator(_printable)
]
EnvironmentName = Annotated[str, StringConstraints(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=128)]
Url = Annotated[str, StringConstraints(min_length=1, max_length=2048), AfterValidator(_url_without_password)]
